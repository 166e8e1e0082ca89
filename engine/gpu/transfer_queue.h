// The queue of a device's copy engine. Uploads run there while the main queue computes and draws; devices without such
// an engine copy on the main queue.
#pragma once

#include <volk.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

namespace neuvv::gpu {

// Any thread may use it. Main queue and transfer queue share all buffers (VK_SHARING_MODE_CONCURRENT).
class TransferQueue {
  public:
    // The family of queues that can copy, and neither compute nor draw; nothing: the device has none.
    static std::optional<uint32_t> family_of(VkPhysicalDevice physical);

    // The device must have been created with a queue of the family.
    TransferQueue(VkDevice device, uint32_t family);
    ~TransferQueue();
    TransferQueue(const TransferQueue&) = delete;
    TransferQueue& operator=(const TransferQueue&) = delete;

    uint32_t family() const { return family_; }
    VkQueue handle() const { return queue_; }
    VkSemaphore semaphore() const { return semaphore_; }
    // submit() locks it. Whoever waits for all queues of the device must lock it, too.
    std::mutex& mutex() { return mutex_; }

    // Submits commands that only copy between buffers, and returns the number of the submission; `name` is what errors
    // say. Throws VulkanError.
    uint64_t submit(const VkCommandBufferSubmitInfo& commands, VkFence fence, const std::string& name);
    // To be called when the fence of the submission is signalled.
    void set_finished(uint64_t number);
    // What the next submission to the main queue has to wait for, so that it and all later ones see what finished
    // submissions wrote; nothing where an earlier one waited for the same. It is signalled already, so the queue does
    // not stand still. set_seen() is to be called with the value once that submission has succeeded. The main queue's
    // mutex must be locked for both.
    std::optional<VkSemaphoreSubmitInfo> unseen() const;
    void set_seen(uint64_t value) { seen_by_main_ = value; }

  private:
    VkDevice device_;
    uint32_t family_;
    VkQueue queue_ = VK_NULL_HANDLE;
    std::mutex mutex_;
    VkSemaphore semaphore_ = VK_NULL_HANDLE;  // a timeline: the number of the last submission that is done
    uint64_t submitted_ = 0;                  // the number of the last submission
    std::atomic<uint64_t> finished_ = 0;      // set_finished() was called for it, and all before it are done
    uint64_t seen_by_main_ = 0;
};

}  // namespace neuvv::gpu
