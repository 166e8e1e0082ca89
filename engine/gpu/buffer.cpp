#include "gpu/buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "base/error.h"

namespace neuvv::gpu {

uint32_t texel_bytes(VkFormat format) {
    switch (format) {
        case VK_FORMAT_R32_UINT:
        case VK_FORMAT_R32_SFLOAT:
            return 4;
        case VK_FORMAT_R32G32_UINT:
        case VK_FORMAT_R32G32_SFLOAT:
        case VK_FORMAT_R16G16B16A16_SFLOAT:
            return 8;
        case VK_FORMAT_R32G32B32A32_UINT:
        case VK_FORMAT_R32G32B32A32_SFLOAT:
            return 16;
        default:
            throw RuntimeFailure(fmt::format("texel_bytes: format {} is not in the table", static_cast<int>(format)));
    }
}

namespace {

struct MemoryFlags {
    VkMemoryPropertyFlags preferred, required;
};

constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

MemoryFlags flags_of(MemoryKind kind) {
    switch (kind) {
        case MemoryKind::kDevice:
        case MemoryKind::kShared:
            return {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
        case MemoryKind::kUpload:
            return {kHost | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, kHost};
        case MemoryKind::kReadback:
            return {kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, kHost};
    }
    return {};
}

// Whether the buffer fits into a texel buffer of the device. Throws where passes have no other way to bind it.
bool fits_texels(const Buffer& buffer, VkFormat format) {
    const BufferLimits& limits = buffer.device->buffers();
    const uint64_t texels = buffer.bytes / texel_bytes(format);
    if (texels <= limits.texels) return true;
    const bool fits_storage = buffer.bytes <= limits.storage_bytes;
    if (fits_storage && limits.profile == BufferProfile::kStorage) return false;
    throw RuntimeFailure(
        fmt::format("buffer \"{}\" needs {} texels or {:.1f} MiB, device \"{}\" binds texel buffers of {} and storage "
                    "buffers of {} MiB",
                    buffer.name, texels, static_cast<double>(buffer.bytes) / 1048576, buffer.device->summary().name,
                    limits.texels, limits.storage_bytes >> 20),
        fits_storage && limits.allow_storage() ? Fix("NEUVV_BUFFERS=storage takes the latter")
                                               : Fix(Remedy::kFewerLeaves));
}

}  // namespace

// Delegates to the default constructor, so that the destructor frees what was created when a later step throws.
Buffer::Buffer(const Device& owner, std::string label, uint64_t size, MemoryKind kind, VkFormat texel_format)
    : Buffer() {
    device = &owner;
    name = std::move(label);
    bytes = std::max<uint64_t>(size, 16);
    const bool has_view = texel_format != VK_FORMAT_UNDEFINED && fits_texels(*this, texel_format);
    if (bytes > owner.max_allocation_bytes())
        throw RuntimeFailure(fmt::format("buffer \"{}\" needs {} MiB, device \"{}\" allocates at most {} MiB at once",
                                         name, bytes >> 20, owner.summary().name, owner.max_allocation_bytes() >> 20));

    std::array<uint32_t, 2> families{};
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = bytes;
    info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                 VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                 VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    if (owner.buffer_addresses()) info.usage |= VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    if (const TransferQueue* transfers = owner.transfer_queue()) {
        families = {owner.queue_family(), transfers->family()};
        info.sharingMode = VK_SHARING_MODE_CONCURRENT;
        info.queueFamilyIndexCount = static_cast<uint32_t>(families.size());
        info.pQueueFamilyIndices = families.data();
    }
    check(vkCreateBuffer(owner.handle(), &info, nullptr, &buffer), "vkCreateBuffer", name);
    VkMemoryRequirements requirements{};
    vkGetBufferMemoryRequirements(owner.handle(), buffer, &requirements);

    const MemoryFlags flags = flags_of(kind);
    const uint32_t type = owner.memory_type(requirements.memoryTypeBits, flags.preferred, flags.required);
    const bool maps =
        kind == MemoryKind::kShared ? (owner.memory_flags(type) & kHost) == kHost : kind != MemoryKind::kDevice;
    owner.check_memory(owner.memory_pool().take(owner.handle(), requirements.size, type, maps, memory), name,
                       requirements.size);
    mapped = memory.mapped;
    owner.count_buffer_bytes(bytes, 0);
    check(vkBindBufferMemory(owner.handle(), buffer, memory.memory, 0), "vkBindBufferMemory", name);
    owner.name_object(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer), name);
    owner.name_object(VK_OBJECT_TYPE_DEVICE_MEMORY, reinterpret_cast<uint64_t>(memory.memory), name);

    if (has_view) {
        VkBufferViewCreateInfo view_info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
        view_info.buffer = buffer;
        view_info.format = texel_format;
        view_info.range = VK_WHOLE_SIZE;
        check(vkCreateBufferView(owner.handle(), &view_info, nullptr, &view), "vkCreateBufferView", name);
        owner.name_object(VK_OBJECT_TYPE_BUFFER_VIEW, reinterpret_cast<uint64_t>(view), name);
    }
}

Buffer::~Buffer() {
    if (!device) return;
    vkDestroyBufferView(device->handle(), view, nullptr);
    vkDestroyBuffer(device->handle(), buffer, nullptr);
    device->memory_pool().give(device->handle(), memory);
    if (memory.memory) device->count_buffer_bytes(0, bytes);
}

glm::uvec2 Buffer::address() const {
    assert(device->buffer_addresses());
    const VkBufferDeviceAddressInfo info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, buffer};
    const uint64_t address = vkGetBufferDeviceAddress(device->handle(), &info);
    return {static_cast<uint32_t>(address), static_cast<uint32_t>(address >> 32)};
}

Buffer::Buffer(Buffer&& other) noexcept {
    *this = std::move(other);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device, other.device);
    std::swap(name, other.name);
    std::swap(buffer, other.buffer);
    std::swap(memory, other.memory);
    std::swap(view, other.view);
    std::swap(bytes, other.bytes);
    std::swap(mapped, other.mapped);
    return *this;
}

}  // namespace neuvv::gpu
