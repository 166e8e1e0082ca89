// engine/gpu: selection of a device, limits, copies, reflection and bindings.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>

#include "base/error.h"
#include "base/seconds.h"
#include "gpu/commands.h"
#include "gpu/host_copies.h"
#include "shared/inspect.h"
#include "shared/resolve.h"
#include "shared/set.h"
#include "shared/slice.h"
#include "shared/trace.h"
#include "spirv/direct.comp.h"
#include "spirv/inspect.comp.h"
#include "spirv/resolve.comp.h"
#include "spirv/rows.comp.h"
#include "spirv/set.frag.h"
#include "spirv/set.vert.h"
#include "spirv/set_shadow.frag.h"
#include "spirv/slice_colour.comp.h"
#include "spirv/slice_density.comp.h"
#include "spirv/trace.comp.h"
#include "support/gpu_test.h"
#include "support/input_error.h"

namespace neuvv::test {
namespace {

template <typename Call>
void expect_failure(Call&& call, const std::string& part) {
    try {
        call();
        ADD_FAILURE() << "no RuntimeFailure";
    } catch (const RuntimeFailure& failure) {
        EXPECT_NE(std::string(failure.what()).find(part), std::string::npos) << failure.what();
    }
}

using DeviceTest = GpuTest;

TEST_F(DeviceTest, IsNamedByIndexOrByPartOfItsName) {
    const gpu::DeviceSummary& shared = device().summary();
    EXPECT_EQ(gpu::Device(std::to_string(shared.index), gpu::Validation::kOn).summary().index, shared.index);
    std::string part = shared.name.substr(0, 5);
    for (char& c : part) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    EXPECT_EQ(gpu::Device(part, gpu::Validation::kOn).summary().kind, shared.kind);
    const std::vector<gpu::DeviceSummary> all = gpu::list_devices();
    ASSERT_LT(shared.index, all.size());
    EXPECT_EQ(all[shared.index].name, shared.name);
    EXPECT_TRUE(all[shared.index].missing.empty());
}

TEST_F(DeviceTest, AChoiceThatFitsNoneIsBadInput) {
    expect_input_error([] { gpu::Device("no such device", gpu::Validation::kOn); },
                       {"no such device", "list of devices"});
    expect_input_error([] { gpu::Device("999", gpu::Validation::kOn); }, {"999", "list of devices"});
    const char* environment = std::getenv("NEUVV_DEVICE");
    const std::string before = environment ? environment : "";
    ASSERT_EQ(setenv("NEUVV_DEVICE", "from the environment", 1), 0);
    expect_input_error([] { gpu::Device("", gpu::Validation::kOn); }, {"from the environment"});
    ASSERT_EQ(environment ? setenv("NEUVV_DEVICE", before.c_str(), 1) : unsetenv("NEUVV_DEVICE"), 0);
}

TEST_F(DeviceTest, ValidationIsHeard) {
    // A buffer without usage flags is an error. The layers must report it; otherwise no test would notice errors.
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = 16;
    const VkDevice handle = device().handle();
    VkBuffer buffer = VK_NULL_HANDLE;
    vkCreateBuffer(handle, &info, nullptr, &buffer);
    vkDestroyBuffer(handle, buffer, nullptr);
    EXPECT_FALSE(device().drain_validation_messages().empty());
    EXPECT_TRUE(device().drain_validation_messages().empty());
}

TEST_F(DeviceTest, PassesTakeTheNewestShaders) {
    const std::vector<uint32_t> rows(std::begin(rows_comp), std::end(rows_comp)),
        resolve(std::begin(resolve_comp), std::end(resolve_comp));
    const auto bindings = [&] { return gpu::ComputePass(device(), "rows", rows_comp).interface().bindings.size(); };
    const size_t of_rows = gpu::reflect(rows, "rows").bindings.size(),
                 of_resolve = gpu::reflect(resolve, "resolve").bindings.size();
    ASSERT_NE(of_rows, of_resolve);
    EXPECT_EQ(bindings(), of_rows);
    device().shaders().set({{rows, resolve}});
    EXPECT_EQ(bindings(), of_resolve);
    EXPECT_EQ(gpu::ComputePass(device(), "resolve", resolve_comp).interface().bindings.size(), of_resolve);
    device().shaders().set({});
    EXPECT_EQ(bindings(), of_rows);
}

TEST_F(DeviceTest, PassesOfOneShaderAndTheSameConstantsShareTheirPipeline) {
    const auto pipeline = [&](std::span<const uint32_t> spirv, const std::vector<uint32_t>& constants) {
        return gpu::ComputePass(device(), "shared", spirv, constants).pipeline();
    };
    const VkPipeline first = pipeline(rows_comp, {1});
    EXPECT_EQ(pipeline(rows_comp, {1}), first) << "also where the first pass is gone";
    EXPECT_NE(pipeline(rows_comp, {2}), first);
    EXPECT_NE(pipeline(resolve_comp, {1}), first);
}

using BufferTest = GpuTest;

TEST_F(BufferTest, LimitsAreNamed) {
    const uint64_t texels = uint64_t{device().limits().maxTexelBufferElements} + 1;
    expect_failure(
        [&] { gpu::Buffer(device(), "wide", 4 * texels, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT); },
        fmt::format("binds texel buffers of {} and storage buffers of {} MiB", device().limits().maxTexelBufferElements,
                    device().limits().maxStorageBufferRange >> 20));
    if (4 * texels > device().limits().maxStorageBufferRange)
        expect_failure([&] { gpu::Buffer(device(), "wide", 4 * texels, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT); },
                       "choose a clip of fewer leaves");
    const uint64_t bytes = device().max_allocation_bytes() + 1;
    expect_failure([&] { gpu::Buffer(device(), "heavy", bytes, gpu::MemoryKind::kDevice); }, "\"heavy\"");
    expect_failure([] { gpu::texel_bytes(VK_FORMAT_R8_UNORM); }, "texel_bytes");
}

// Data longer than a staging buffer, with every kind of float bit pattern.
TEST_F(BufferTest, WhatGoesUpComesDown) {
    std::vector<float> data((uint64_t{64} << 20) / sizeof(float) + 1023);
    for (size_t i = 0; i < data.size(); ++i) data[i] = static_cast<float>(i % 8191) - 0.1f;
    data[0] = std::numeric_limits<float>::infinity();
    data[1] = std::bit_cast<float>(0x7fc12345u);
    data[2] = std::numeric_limits<float>::denorm_min();
    data[3] = -0.0f;
    const uint64_t bytes = data.size() * sizeof(float);
    const gpu::Buffer buffer(device(), "round trip", bytes, gpu::MemoryKind::kDevice, VK_FORMAT_R32_SFLOAT);
    gpu::upload(device(), buffer, data.data(), bytes);
    std::vector<float> back(data.size());
    gpu::download(device(), buffer, back.data(), bytes);
    EXPECT_EQ(std::memcmp(back.data(), data.data(), bytes), 0);
    expect_failure([&] { gpu::upload(device(), buffer, data.data(), buffer.bytes + 1); }, "\"round trip\"");
    expect_failure([&] { gpu::download(device(), buffer, back.data(), buffer.bytes + 1); }, "\"round trip\"");
}

// Together they are longer than a staging buffer, whose end lies within one of them.
TEST_F(BufferTest, SeveralGoUpTogether) {
    std::vector<std::vector<uint32_t>> values;
    for (const size_t count : {size_t{11} << 20, size_t{3}, size_t{0}, size_t{9} << 20, size_t{1}}) {
        std::vector<uint32_t>& all = values.emplace_back(count);
        for (size_t i = 0; i < count; ++i) all[i] = static_cast<uint32_t>(i * 2654435761u + values.size());
    }
    gpu::Uploads uploads(device());
    std::vector<gpu::Buffer> buffers;
    for (const auto& all : values) {
        const bool is_written = buffers.size() % 2 == 1;  // at once, where the host sees the device's memory
        buffers.push_back(
            is_written ? uploads.add_written("one of several", all.size() * sizeof(uint32_t), VK_FORMAT_R32_UINT,
                                             [&](void* to) { std::ranges::copy(all, static_cast<uint32_t*>(to)); })
                       : uploads.add("one of several", all, VK_FORMAT_R32_UINT));
    }
    uploads.finish();
    uploads.finish();  // nothing is left
    for (size_t i = 0; i < values.size(); ++i) {
        std::vector<uint32_t> back(values[i].size());
        gpu::download(device(), buffers[i], back.data(), back.size() * sizeof(uint32_t));
        EXPECT_EQ(back, values[i]) << i;
    }
    expect_failure([&] { uploads.add(buffers[1], values[0].data(), buffers[1].bytes + 1); }, "\"one of several\"");
}

TEST_F(BufferTest, EmptyOnesHoldATexelAndMovesLeaveNothing) {
    gpu::Buffer buffer(device(), "empty", 0, gpu::MemoryKind::kUpload, VK_FORMAT_R32G32B32A32_SFLOAT);
    EXPECT_EQ(buffer.bytes, 16u);
    ASSERT_NE(buffer.mapped, nullptr);
    const gpu::Buffer moved = std::move(buffer);
    EXPECT_NE(moved.buffer, VkBuffer{VK_NULL_HANDLE});
    EXPECT_EQ(buffer.buffer, VkBuffer{VK_NULL_HANDLE});  // NOLINT(bugprone-use-after-move): that is tested
}

TEST_F(BufferTest, MemoryOfThoseThatAreGoneIsTakenAgain) {
    const auto memory_of = [](uint64_t bytes, gpu::MemoryKind kind = gpu::MemoryKind::kDevice) {
        return gpu::Buffer(device(), "short-lived", bytes, kind).memory;  // the buffer is gone with the statement
    };
    const gpu::DeviceMemory first = memory_of(3 << 20);
    EXPECT_GE(first.bytes, uint64_t{3} << 20);
    EXPECT_LE(8 * first.bytes, 9 * (uint64_t{3} << 20)) << "an eighth more at most";
    EXPECT_EQ(memory_of((3 << 20) - 5000).memory, first.memory) << "of about the same size";
    EXPECT_NE(memory_of(1 << 20).memory, first.memory) << "of another size";
    const gpu::Buffer holds(device(), "holds it", 3 << 20, gpu::MemoryKind::kDevice);
    EXPECT_EQ(holds.memory.memory, first.memory);
    EXPECT_NE(memory_of(3 << 20).memory, first.memory) << "it is in use";
    const gpu::DeviceMemory mapped = memory_of(2 << 20, gpu::MemoryKind::kReadback);
    gpu::Buffer readback(device(), "readback", 2 << 20, gpu::MemoryKind::kReadback);
    EXPECT_EQ(readback.memory.memory, mapped.memory);
    ASSERT_NE(readback.mapped, nullptr);
    readback.as<uint8_t>()[(2 << 20) - 1] = 7;
    EXPECT_EQ(gpu::Buffer(device(), "not mapped", 2 << 20, gpu::MemoryKind::kDevice).mapped, nullptr);
}

TEST(Reflect, ShadersAndHeadersAgreeOnPushConstants) {
    EXPECT_EQ(gpu::reflect(rows_comp, "rows").push_bytes, sizeof(RowsPush));
    EXPECT_EQ(gpu::reflect(slice_density_comp, "slice density").push_bytes, sizeof(SlicePush));
    EXPECT_EQ(gpu::reflect(slice_colour_comp, "slice colour").push_bytes, sizeof(SlicePush));
    EXPECT_EQ(gpu::reflect(trace_comp, "trace").push_bytes, sizeof(TracePush));
    EXPECT_EQ(gpu::reflect(direct_comp, "direct").push_bytes, sizeof(TracePush));
    EXPECT_EQ(gpu::reflect(resolve_comp, "resolve").push_bytes, sizeof(ResolvePush));
    EXPECT_EQ(gpu::reflect(inspect_comp, "inspect").push_bytes, sizeof(InspectPush));
    EXPECT_EQ(gpu::reflect(set_vert, "set").push_bytes, sizeof(SetPush));
    EXPECT_EQ(gpu::reflect(set_frag, "set").push_bytes, sizeof(SetPush));
    EXPECT_EQ(gpu::reflect(set_shadow_frag, "set shadow").push_bytes, sizeof(SetPush));
}

TEST(Reflect, FindsEveryKindOfBinding) {
    struct Expected {
        uint32_t binding;
        VkDescriptorType texel, storage;
    };
    const std::array<Expected, 5> expected = {{
        {kSliceWeights, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
        {kSliceRows, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
        {kSliceLeaves, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
        {kSliceLive, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
        {kSliceSh, VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
    }};
    const auto texel = gpu::reflect(slice_colour_comp, "slice colour").bindings,
               storage = gpu::reflect(slice_colour_comp_storage, "slice colour").bindings;
    ASSERT_EQ(texel.size(), expected.size());
    ASSERT_EQ(storage.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(texel[i].binding, expected[i].binding);
        EXPECT_EQ(texel[i].type, expected[i].texel);
        EXPECT_EQ(storage[i].binding, expected[i].binding);
        EXPECT_EQ(storage[i].type, expected[i].storage);
    }
}

TEST(Reflect, ReadsTheThreadsOfAWorkgroup) {
    EXPECT_EQ(gpu::reflect(slice_density_comp, "slice density").group_threads, kSliceGroup);
    EXPECT_EQ(gpu::reflect(trace_comp, "trace").group_threads, kTilePixels);
    EXPECT_EQ(gpu::reflect(set_vert, "set").group_threads, 0u);
    EXPECT_EQ(gpu::groups_of(0, 64), 0u);
    EXPECT_EQ(gpu::groups_of(64, 64), 1u);
    EXPECT_EQ(gpu::groups_of(65, 64), 2u);
    EXPECT_EQ(gpu::groups_of(uint64_t{1} << 33, 64), 1u << 27);
}

TEST(Reflect, RefusesWhatIsNoShader) {
    constexpr uint32_t kWords[] = {1, 2, 3, 4, 5, 6, 7};
    expect_failure([&] { gpu::reflect(kWords, "garbage"); }, "\"garbage\"");
    expect_failure([] { gpu::reflect({}, "nothing"); }, "\"nothing\"");
    const std::span<const uint32_t> cut(resolve_comp, std::size(resolve_comp) / 2);
    expect_failure([&] { gpu::reflect(cut, "cut"); }, "\"cut\"");
}

using BindingTest = GpuTest;

TEST_F(BindingTest, EveryBindingWantsAFittingBuffer) {
    const gpu::ComputePass pass(device(), "resolve", resolve_comp);
    const gpu::Buffer radiance(device(), "radiance", 1024, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32B32A32_SFLOAT);
    const gpu::Buffer depth(device(), "depth", 256, gpu::MemoryKind::kDevice, VK_FORMAT_R32_SFLOAT);
    const gpu::Buffer image(device(), "image", 256, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT);
    const gpu::Buffer plain(device(), "plain", 256, gpu::MemoryKind::kDevice), none;
    const auto bind = [&](const gpu::Buffer& in, uint32_t last) {
        gpu::BindingSet(pass, {{kResolveRadiance, &in},
                               {kResolveDepth, &depth},
                               {kResolveTiles, &image},
                               {kResolveCameras, &radiance},
                               {kResolveSetColour, &radiance},
                               {kResolveSetFront, &radiance},
                               {kResolveSetDepth, &depth},
                               {last, &image}});
    };
    EXPECT_NO_THROW(bind(radiance, kResolveImage));
    expect_failure([&] { bind(radiance, 17); }, "no buffer for binding 2");
    expect_failure([&] { bind(none, kResolveImage); }, "no buffer for binding 0");
    expect_failure([&] { bind(plain, kResolveImage); }, "\"plain\" has no texel format");
}

TEST_F(BindingTest, AStorageBufferBeyondTheRangeIsNamed) {
    const uint64_t bytes = uint64_t{device().limits().maxStorageBufferRange} + 4;
    // The test has to create a buffer beyond the range. Real GPUs bind 2 or 4 GiB, which is too much for a test.
    if (bytes > uint64_t{1} << 30) GTEST_SKIP() << "this device binds storage buffers of " << (bytes >> 20) << " MiB";
    const gpu::ComputePass pass(device(), "rows", rows_comp);
    const gpu::Buffer basis(device(), "basis", 64, gpu::MemoryKind::kDevice, VK_FORMAT_R32_SFLOAT);
    const gpu::Buffer live(device(), "live", sizeof(LiveCount), gpu::MemoryKind::kDevice);
    const gpu::Buffer huge(device(), "huge rows", bytes, gpu::MemoryKind::kDevice);
    expect_failure(
        [&] {
            gpu::BindingSet(
                pass, {{kRowsSigmaBasis, &basis}, {kRowsGammaBasis, &basis}, {kRowsOut, &huge}, {kRowsLive, &live}});
        },
        "\"huge rows\"");
    const gpu::Buffer with_view(device(), "huge view", bytes, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32B32A32_SFLOAT);
    expect_failure(
        [&] {
            gpu::BindingSet(
                pass,
                {{kRowsSigmaBasis, &basis}, {kRowsGammaBasis, &basis}, {kRowsOut, &with_view}, {kRowsLive, &live}});
        },
        "NEUVV_BUFFERS=texel takes the latter");
}

TEST_F(BindingTest, PassTimesAreThoseOfTheScopes) {
    gpu::Commands commands(device(), "timed");
    EXPECT_TRUE(commands.pass_times().empty());
    const gpu::Buffer buffer(device(), "filled", 1 << 20, gpu::MemoryKind::kReadback);
    const double begin_s = seconds_now();
    commands.begin();
    for (const char* name : {"first", "second"}) {
        const gpu::PassScope scope(commands, name);
        gpu::fill(commands, buffer, 0x12345678u);
        gpu::compute_barrier(commands);
    }
    gpu::host_barrier(commands);
    commands.submit();
    commands.wait();
    const std::vector<gpu::PassTime> times = commands.pass_times();
    ASSERT_EQ(times.size(), 2u);
    EXPECT_EQ(times[1].name, "second");
    EXPECT_GE(times[0].milliseconds, 0);
    EXPECT_LT(times[0].milliseconds, 1e3 * (seconds_now() - begin_s));
    EXPECT_EQ(buffer.as<uint32_t>()[(1 << 18) - 1], 0x12345678u);
}

}  // namespace
}  // namespace neuvv::test
