#include "gpu/buffer_speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/platform.h"
#include "gpu/commands.h"
#include "gpu/host_copies.h"
#include "shared/buffer_speed.h"
#include "spirv/buffer_speed.comp.h"

namespace neuvv::gpu {

namespace {

constexpr double kClearlyFaster = 0.9;  // of the other's time
constexpr double kLongEnoughMs = 1;     // for a time to be told from what launches and clocks add
constexpr uint32_t kFirstThreads = 1u << 13, kMostThreads = 1u << 22;
constexpr int kTurns = 5;
constexpr uintmax_t kMostFileBytes = 4096;
constexpr double kLeastMs = 1e-6, kMostMs = 1e6;  // of times in the file; clocks may say 0

// What must be the same for times to be valid.
std::string key_of(const DeviceSummary& device) {
    return fmt::format("{}, {}, NeuVV {}", device.name, device.driver, NEUVV_VERSION);
}

// Entries whose chains lead everywhere, while eight neighbours stay together, as rays do.
std::vector<glm::uvec2> chained_entries() {
    std::vector<glm::uvec2> entries(kSpeedElements);
    for (uint32_t i = 0; i < kSpeedElements; ++i) {
        const uint32_t next = (i / 8 * 2654435761u >> 7) % (kSpeedElements / 8);
        entries[i] = {8 * next + i % 8, 0};
    }
    return entries;
}

// One profile's pass and what it reads.
struct TimedReads {
    TimedReads(const Device& device, std::span<const uint32_t> spirv, const Bindings& bindings)
        : pass(device, "buffer speed", spirv), set(pass, bindings) {}
    double milliseconds(Commands& commands, uint32_t threads) const {
        commands.begin();
        {
            const PassScope scope(commands, "buffer speed");
            dispatch(commands, pass, set, threads, nullptr, 0);
        }
        commands.submit();
        commands.wait();
        return commands.pass_times().at(0).milliseconds;
    }
    ComputePass pass;
    BindingSet set;
};

}  // namespace

std::filesystem::path profile_times_file(const DeviceSummary& device) {
    const std::filesystem::path folder = cache_folder();
    if (folder.empty()) return {};
    return folder / fmt::format("buffers-{:016x}.json", std::hash<std::string>{}(key_of(device)));
}

std::optional<ProfileTimes> read_profile_times(const std::filesystem::path& file, const DeviceSummary& device) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
    if (std::filesystem::file_size(file, error) > kMostFileBytes || error) return std::nullopt;
    try {
        const JsonFile json = read_json(file, "times of buffers");
        if (json_string(json.root()["key"]) != key_of(device)) return std::nullopt;
        const auto time = [&](const char* name) { return json_number(json.root()[name], kLeastMs, kMostMs, "a time"); };
        return ProfileTimes{time("texel_ms"), time("storage_ms")};
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

void write_profile_times(const std::filesystem::path& file, const DeviceSummary& device, const ProfileTimes& times) {
    if (file.empty()) return;
    try {
        const std::string text =
            json_text({{"key", key_of(device)}, {"texel_ms", times.texel_ms}, {"storage_ms", times.storage_ms}});
        write_file_atomically(file, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
    } catch (const RuntimeFailure&) {  // see above
    }
}

ProfileTimes measure_profiles(const Device& device) {
    const Buffer weights(device, "speed weights", 8 * kSpeedElements, MemoryKind::kDevice,
                         VK_FORMAT_R16G16B16A16_SFLOAT);
    const Buffer entries = uploaded(device, "speed entries", chained_entries(), VK_FORMAT_R32G32_UINT);
    const Buffer out(device, "speed out", 16, MemoryKind::kDevice);
    run_once(device, "speed weights", [&](Commands& once) { fill(once, weights, 0); });
    const Bindings bindings = {{kSpeedWeights, &weights}, {kSpeedEntries, &entries}, {kSpeedOut, &out}};
    const TimedReads texel(device, buffer_speed_comp, bindings), storage(device, buffer_speed_comp_storage, bindings);

    Commands commands(device, "buffer speed");
    uint32_t threads = kFirstThreads;
    storage.milliseconds(commands, threads);
    while (texel.milliseconds(commands, threads) < kLongEnoughMs && threads < kMostThreads) threads *= 2;
    ProfileTimes best{kMostMs, kMostMs};
    for (int i = 0; i < kTurns; ++i) {
        best.texel_ms = std::min(best.texel_ms, texel.milliseconds(commands, threads));
        best.storage_ms = std::min(best.storage_ms, storage.milliseconds(commands, threads));
    }
    return {std::max(best.texel_ms, kLeastMs), std::max(best.storage_ms, kLeastMs)};
}

BufferProfile faster(const ProfileTimes& times) {
    return times.storage_ms < kClearlyFaster * times.texel_ms ? BufferProfile::kStorage : BufferProfile::kTexel;
}

void choose_by_kept_times(DeviceSummary& summary) {
    BufferLimits& limits = summary.buffers;
    if (limits.reason != ProfileReason::kSpeed) return;
    limits.times = read_profile_times(profile_times_file(summary), summary);
    if (limits.times) limits.profile = faster(*limits.times);
}

void choose_by_speed(const Device& device, DeviceSummary& summary) {
    BufferLimits& limits = summary.buffers;
    choose_by_kept_times(summary);
    if (limits.reason != ProfileReason::kSpeed || limits.times) return;
    try {
        limits.times = measure_profiles(device);
    } catch (const VulkanError& error) {
        if (!error.out_of_memory()) throw;
        return;
    }
    limits.profile = faster(*limits.times);
    write_profile_times(profile_times_file(summary), summary, *limits.times);
}

}  // namespace neuvv::gpu
