// The Vulkan device: its selection, its creation with exactly the features of a table (features.h), and its validation
// messages.
#pragma once

#include <volk.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/error.h"
#include "gpu/buffer_profile.h"
#include "gpu/device_clock.h"
#include "gpu/heap_memory.h"
#include "gpu/memory_pool.h"
#include "gpu/shader_table.h"
#include "gpu/transfer_queue.h"

namespace neuvv::gpu {

class ComputePrograms;
class DebugBuffer;

// A Vulkan call failed. After the loss of a device nothing of the device can be used any more, and all that is made of
// it can only be destroyed; other failures, such as a lack of memory, leave it usable.
struct VulkanError : RuntimeFailure {
    VulkanError(VkResult result, const char* call, const std::string& object);
    VulkanError(VkResult failed, const std::string& cause, const Fix& fix = {})
        : RuntimeFailure(cause, fix), result(failed) {}
    bool device_lost() const { return result == VK_ERROR_DEVICE_LOST; }
    bool out_of_memory() const;
    VkResult result;
};

// Throws VulkanError, which names the call, the object and the result, unless the result is VK_SUCCESS.
void check(VkResult result, const char* call, const std::string& object);

enum class Validation { kOff, kOn };

struct DeviceSummary {
    uint32_t index = 0;
    std::string name;    // "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string kind;    // "discrete", "integrated", "virtual", "cpu", "other"
    std::string driver;  // "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"
    uint32_t api_version = 0;
    HeapMemory memory;
    BufferLimits buffers;
    bool transfer_queue = false;       // whether uploads run beside drawing (TransferQueue)
    std::vector<std::string> missing;  // required features that it lacks, as the table names them; empty: usable
    std::vector<std::string> missing_optional;  // optional features that it lacks, each with its substitute
};

// Lists every Vulkan device of this machine, usable or not. Throws RuntimeFailure where no Vulkan loader is installed.
std::vector<DeviceSummary> list_devices();

// The indices of all usable devices of the best kind that this machine has (see Device), for programs that start a
// process for each.
std::vector<uint32_t> best_devices();

// Extensions beyond those that every device is created with: those that windows (Swapchain) and headsets need. Names
// must be literals or outlive the device.
struct DeviceExtensions {
    std::vector<const char*> instance, device;
};

// Functions of a headset's runtime, which then creates the Vulkan instance and the device in place of this program.
// Either all functions are set or none.
struct DeviceMaker {
    std::function<VkResult(const VkInstanceCreateInfo&, VkInstance*)> create_instance;
    // Returns the only device that can drive the headset: a choice that names another one is an error.
    std::function<VkPhysicalDevice(VkInstance)> choose_physical;
    std::function<VkResult(VkPhysicalDevice, const VkDeviceCreateInfo&, VkDevice*)> create_device;
};

class Device {
  public:
    // `choice` is an index or a part of a name (case-insensitive). Where it is empty, NEUVV_DEVICE of the environment
    // counts, else the best usable device is taken, in the order discrete, integrated, virtual, other, cpu. Takes no
    // more memory than memory_limit_of_environment(). Where nothing else decides how passes bind long arrays, both ways
    // are timed once (buffer_speed.h). Throws InputError for a choice that fits no device and for a wrong limit,
    // RuntimeFailure for a device that lacks a required feature or one of `extensions`.
    explicit Device(const std::string& choice = "", Validation validation = Validation::kOff,
                    const DeviceExtensions& extensions = {}, const DeviceMaker& maker = {});
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkInstance instance() const { return instance_; }
    VkDevice handle() const { return device_; }
    VkPhysicalDevice physical() const { return physical_; }
    // The main queue, of all threads. A thread must lock the mutex while it submits to the queue, presents or waits.
    VkQueue queue() const { return queue_; }
    std::mutex& queue_mutex() const { return queue_mutex_; }
    uint32_t queue_family() const { return queue_family_; }
    // Null: uploads run on the main queue.
    TransferQueue* transfer_queue() const { return transfer_queue_.get(); }
    VkPipelineCache pipeline_cache() const { return pipeline_cache_; }
    ShaderTable& shaders() const { return shaders_; }
    ComputePrograms& programs() const { return *programs_; }
    const VkPhysicalDeviceLimits& limits() const { return limits_; }
    uint64_t max_allocation_bytes() const { return max_allocation_bytes_; }
    const DeviceSummary& summary() const { return summary_; }
    const BufferLimits& buffers() const { return summary_.buffers; }
    bool float_atomics() const { return float_atomics_; }
    // Whether shaders may read buffers by their addresses, which the storage profile does (buffer_profile.h).
    bool buffer_addresses() const { return buffers().addresses; }
    // Whether a vertex shader may select the layer that it draws to.
    bool output_layer() const { return output_layer_; }
    bool validating() const { return messenger_ != VK_NULL_HANDLE; }

    // The bytes of all buffers that exist on the device now. Buffer counts them.
    uint64_t buffer_bytes() const { return buffer_bytes_; }
    void count_buffer_bytes(uint64_t more, uint64_t less) const { buffer_bytes_ += more - less; }

    MemoryPool& memory_pool() const { return memory_pool_; }
    // The memory now. With a limit (limit_memory), budget and size are at most that.
    HeapMemory memory() const;
    // From now on, allocations beyond so many bytes fail; nothing: only where the device has no more.
    void limit_memory(std::optional<uint64_t> bytes) const;
    // Throws VulkanError, unless the result of an allocation is VK_SUCCESS. Where the device has no memory, it says how
    // much was asked for and what for, how much the device has, and what to do.
    void check_memory(VkResult result, const std::string& object, uint64_t bytes) const;
    DeviceClock& clock() const { return clock_; }

    // The first memory type of `type_bits` with the flags `preferred`, else the first one with the flags `required`.
    // Throws RuntimeFailure where there is neither.
    uint32_t memory_type(uint32_t type_bits, VkMemoryPropertyFlags preferred, VkMemoryPropertyFlags required) const;
    VkMemoryPropertyFlags memory_flags(uint32_t type) const;  // of a memory type of the device

    // Gives a Vulkan object its debug name (no-op without the debug-utils extension).
    void name_object(VkObjectType type, uint64_t object, const std::string& name) const;

    // Returns the warnings and errors of the validation layers since the last call.
    std::vector<std::string> drain_validation_messages() const;

    // The buffer of what shaders print and assert. The first call of debug_buffer() creates it; used_debug_buffer() is
    // null before that.
    DebugBuffer& debug_buffer() const;
    DebugBuffer* used_debug_buffer() const { return debug_buffer_.get(); }

    // Waits until the device has done all submitted work. Throws VulkanError on device loss; the second, for
    // destructors, returns then.
    void wait_idle() const;
    void wait_idle_or_lost() const;

  private:
    struct Messages;
    explicit Device(std::unique_ptr<Messages> messages);
    void create_instance(Validation validation, const DeviceExtensions& extensions, const DeviceMaker& maker);
    void choose_physical(const std::string& choice, const DeviceMaker& maker);
    void create_device(const DeviceExtensions& extensions, const DeviceMaker& maker);
    void open_pipeline_cache();
    void save_pipeline_cache() const;
    VkResult wait_for_all_queues() const;

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    mutable std::mutex queue_mutex_;
    uint32_t queue_family_ = 0;
    std::unique_ptr<TransferQueue> transfer_queue_;
    VkPipelineCache pipeline_cache_ = VK_NULL_HANDLE;
    mutable ShaderTable shaders_;
    mutable MemoryPool memory_pool_;
    mutable DeviceClock clock_;
    std::unique_ptr<ComputePrograms> programs_;
    VkPhysicalDeviceLimits limits_{};
    uint64_t max_allocation_bytes_ = 0;
    DeviceSummary summary_;
    bool float_atomics_ = false, output_layer_ = false;
    bool debug_utils_ = false;
    mutable std::atomic<uint64_t> buffer_bytes_ = 0;
    std::unique_ptr<Messages> messages_;
    mutable std::once_flag debug_buffer_made_;
    mutable std::unique_ptr<DebugBuffer> debug_buffer_;
};

}  // namespace neuvv::gpu
