// Recording and submitting work on the one queue: dispatches, barriers, copies, and how long each pass took.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "gpu/compute_pass.h"

namespace neuvv::gpu {

struct PassTime {
    std::string name;
    double milliseconds = 0;
};

// What a submission waits for before it draws or copies to an image, and signals when it is done; null: nothing.
struct CommandSemaphores {
    VkSemaphore wait = VK_NULL_HANDLE, signal = VK_NULL_HANDLE;
};

// One command buffer with its fence and timestamps. begin() → record → submit() → wait(); then it may begin again. Of
// one thread at a time; several may be used by as many threads.
class Commands {
  public:
    // So many pass scopes in one submission are timed; what is beyond them is not.
    explicit Commands(const Device& device, std::string name = "commands", uint32_t max_scopes = 128);
    ~Commands();
    Commands(const Commands&) = delete;
    Commands& operator=(const Commands&) = delete;

    void begin();
    void submit(const CommandSemaphores& semaphores = {});
    // Whether wait() would return at once.
    bool is_done() const;
    // Blocks until the submitted work is done. Returns at once when nothing is under way. Throws on device loss.
    void wait();

    VkCommandBuffer handle() const { return buffer_; }
    const Device& device() const { return device_; }

    // A pass begins, and ends by the number that begin_pass gave it: what a PassScope calls.
    uint32_t begin_pass(const std::string& pass);
    void end_pass(uint32_t number);

    // GPU time of each PassScope of the last finished submission, in recording order.
    std::vector<PassTime> pass_times() const;
    // From submit() until wait() knew that the work was done, by the host's clock. Software devices that draw, too,
    // leave compute passes out of their timestamps.
    double milliseconds() const { return milliseconds_; }

  private:
    const Device& device_;
    std::string name_;
    uint32_t max_scopes_;
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
    PassScope(Commands& commands, const std::string& name) : commands_(commands), number_(commands.begin_pass(name)) {}
    ~PassScope() { commands_.end_pass(number_); }
    PassScope(const PassScope&) = delete;
    PassScope& operator=(const PassScope&) = delete;

  private:
    Commands& commands_;
    uint32_t number_;
};

// Push constants must be exactly what the shader declares (assert), here and below.
//
// As many workgroups as hold so many threads; nothing for 0. The shader's own size of a workgroup says how many those
// are, and the shader ignores the threads that are left over.
void dispatch(Commands& commands, const ComputePass& pass, const BindingSet& set, uint64_t threads, const void* push,
              size_t push_bytes);
// So many workgroups, where one of them is the unit of work: a tile of rays, a block of samples.
void dispatch_groups(Commands& commands, const ComputePass& pass, const BindingSet& set, uint32_t groups,
                     const void* push, size_t push_bytes);
// Group counts (three words) come from `arguments` at `offset`, written by an earlier pass.
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

// What compute shaders and copies wrote before is seen by compute shaders, indirect arguments and copies after.
void compute_barrier(Commands& commands);
// What compute shaders and copies wrote before is seen by the shaders of draws after.
void draw_barrier(Commands& commands);
// What compute shaders and copies wrote before is seen by the host after wait().
void host_barrier(Commands& commands);

// The first `bytes` (a multiple of 4), or all.
void fill(Commands& commands, const Buffer& buffer, uint32_t word, uint64_t bytes = VK_WHOLE_SIZE);
// Writes a few bytes (a multiple of 4, at most 64 KiB) that travel in the command buffer itself.
void update(Commands& commands, const Buffer& buffer, const void* data, size_t bytes, uint64_t offset = 0);
template <typename T>
void update(Commands& commands, const Buffer& buffer, const T& value, uint64_t offset = 0) {
    update(commands, buffer, &value, sizeof(T), offset);
}
void copy(Commands& commands, const Buffer& from, const Buffer& to, uint64_t bytes, uint64_t from_offset = 0,
          uint64_t to_offset = 0);

// What was done before, by other submissions too, is seen by all that comes after.
void full_barrier(Commands& commands);

// Records, submits and waits: for set-up and tests, not for frames.
void run_once(const Device& device, const std::string& name, const std::function<void(Commands&)>& record);

// Host ↔ device through a staging buffer in pieces; set-up and tests.
void upload(const Device& device, const Buffer& to, const void* data, uint64_t bytes);
void download(const Device& device, const Buffer& from, void* data, uint64_t bytes);

}  // namespace neuvv::gpu
