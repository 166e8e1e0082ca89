// Recording and submitting work on the device's queues: dispatches, barriers, copies, and how long each pass took.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "gpu/compute_pass.h"

namespace neuvv::gpu {

struct PassTime {
    std::string name;
    double milliseconds = 0;
};

// The semaphore that a submission waits for before it draws or copies to an image, and the semaphore that it signals
// when it is done, for the main queue alone. Null: none.
struct CommandSemaphores {
    VkSemaphore wait = VK_NULL_HANDLE, signal = VK_NULL_HANDLE;
};

// kTransfer: only copies between buffers, without passes and barriers, on the transfer queue where the device has one,
// else on the main queue.
enum class QueueKind { kMain, kTransfer };

// One command buffer with its fence and timestamps. The order is begin(), recording, submit(), wait(); then begin() may
// follow again. Only one thread at a time may use it; different threads may use different objects.
class Commands {
  public:
    // The first `max_scopes` pass scopes of a submission are timed, further ones are not.
    explicit Commands(const Device& device, std::string name = "commands", uint32_t max_scopes = 128,
                      QueueKind queue = QueueKind::kMain);
    ~Commands();
    Commands(const Commands&) = delete;
    Commands& operator=(const Commands&) = delete;

    void begin();
    void submit(const CommandSemaphores& semaphores = {});
    // Whether wait() would return at once.
    bool is_done() const;
    // Blocks until the submitted work is done. Returns at once when nothing was submitted. Throws VulkanError on device
    // loss; it names the pass that had begun and not ended, where that is known.
    void wait();

    VkCommandBuffer handle() const { return buffer_; }
    const Device& device() const { return device_; }

    // Mark the begin and the end of a pass; PassScope calls them. end_pass takes the index that begin_pass returned.
    uint32_t begin_pass(const std::string& pass);
    void end_pass(uint32_t index);

    // GPU time of each timed PassScope of the last finished submission, in the order of recording.
    std::vector<PassTime> pass_times() const;
    // Time from submit() until wait() returned, by the host's clock. It is needed because the timestamps of software
    // devices leave out compute passes where a submission also draws.
    double milliseconds() const { return milliseconds_; }
    // Time from the first timed PassScope's begin to the last one's end, by the device's clock.
    double device_milliseconds() const;

  private:
    Commands(const Device& device, uint32_t max_scopes, QueueKind queue, std::string name);  // without Vulkan objects
    void submit_to_main_queue(const VkCommandBufferSubmitInfo& buffer, const CommandSemaphores& semaphores);
    std::vector<uint64_t> timestamps() const;
    void trace_passes() const;
    std::string unfinished_pass() const;
    const Device& device_;
    std::string name_;
    uint32_t max_scopes_;
    TransferQueue* transfers_;  // null: the main queue
    uint64_t number_ = 0;       // of the last submission to the transfer queue
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer buffer_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    VkQueryPool timestamps_ = VK_NULL_HANDLE;
    std::vector<std::string> scopes_;
    bool in_flight_ = false;
    std::chrono::steady_clock::time_point submitted_;
    double milliseconds_ = 0;
};

// Names a pass in captures and times it on the GPU, for as long as the scope lives.
class PassScope {
  public:
    PassScope(Commands& commands, const std::string& name) : commands_(commands), index_(commands.begin_pass(name)) {}
    ~PassScope() { commands_.end_pass(index_); }
    PassScope(const PassScope&) = delete;
    PassScope& operator=(const PassScope&) = delete;

  private:
    Commands& commands_;
    uint32_t index_;
};

// Here and below, `push_bytes` must be the size that the shader declares (assert).
//
// Dispatches enough workgroups for `threads` threads, or nothing for 0. The size of a workgroup comes from the shader,
// which has to ignore the threads of the last group that are beyond `threads`.
void dispatch(Commands& commands, const ComputePass& pass, const BindingSet& set, uint64_t threads, const void* push,
              size_t push_bytes);
// Dispatches `groups` workgroups, for passes where a workgroup is the unit of work: a tile of rays, a block of samples.
void dispatch_groups(Commands& commands, const ComputePass& pass, const BindingSet& set, uint32_t groups,
                     const void* push, size_t push_bytes);
// Takes the numbers of workgroups from `arguments`: three 32-bit words from byte `offset` on, which an earlier pass
// wrote.
void dispatch_indirect(Commands& commands, const ComputePass& pass, const BindingSet& set, const Buffer& arguments,
                       uint64_t offset, const void* push, size_t push_bytes);

template <typename Push>
void dispatch(Commands& commands, const ComputePass& pass, const BindingSet& set, uint64_t threads, const Push& push) {
    dispatch(commands, pass, set, threads, &push, sizeof(Push));
}
template <typename Push>
void dispatch_groups(Commands& commands, const ComputePass& pass, const BindingSet& set, uint32_t groups,
                     const Push& push) {
    dispatch_groups(commands, pass, set, groups, &push, sizeof(Push));
}
template <typename Push>
void dispatch_indirect(Commands& commands, const ComputePass& pass, const BindingSet& set, const Buffer& arguments,
                       uint64_t offset, const Push& push) {
    dispatch_indirect(commands, pass, set, arguments, offset, &push, sizeof(Push));
}

// Makes what earlier compute shaders and copies wrote visible to later compute shaders, indirect arguments and copies.
void compute_barrier(Commands& commands);
// Makes what earlier compute shaders and copies wrote visible to the shaders of later draws.
void draw_barrier(Commands& commands);
// Makes what earlier compute shaders and copies wrote visible to the host after wait().
void host_barrier(Commands& commands);

// Fills the first `bytes` (a multiple of 4) of the buffer, or all of it, with copies of `word`.
void fill(Commands& commands, const Buffer& buffer, uint32_t word, uint64_t bytes = VK_WHOLE_SIZE);
// Writes a few bytes (a multiple of 4), which are stored in the command buffer itself: what submissions that are still
// under way read stays as it was.
void update(Commands& commands, const Buffer& buffer, const void* data, size_t bytes, uint64_t offset = 0);
template <typename T>
requires(!std::is_pointer_v<T>) void update(Commands& commands, const Buffer& buffer, const T& value,
                                            uint64_t offset = 0) {
    update(commands, buffer, &value, sizeof(T), offset);
}
void copy(Commands& commands, const Buffer& from, const Buffer& to, uint64_t bytes, uint64_t from_offset = 0,
          uint64_t to_offset = 0);

// Makes all that was written before, also by other submissions, visible to all commands after.
void full_barrier(Commands& commands);

// Records, submits and waits: for set-up and tests, not for frames.
void run_once(const Device& device, const std::string& name, const std::function<void(Commands&)>& record);

}  // namespace neuvv::gpu
