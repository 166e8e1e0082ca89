#include "gpu/commands.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "base/error.h"
#include "base/trace_file.h"
#include "gpu/debug_buffer.h"

namespace neuvv::gpu {

Commands::Commands(const Device& device, uint32_t max_scopes, QueueKind queue, std::string name)
    : device_(device),
      name_(std::move(name)),
      max_scopes_(max_scopes),
      transfers_(queue == QueueKind::kTransfer ? device.transfer_queue() : nullptr) {}

// Delegates, so that the destructor frees what was created when a later step throws.
Commands::Commands(const Device& device, std::string name, uint32_t max_scopes, QueueKind queue)
    : Commands(device, max_scopes, queue, std::move(name)) {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = transfers_ ? transfers_->family() : device.queue_family();
    check(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_), "vkCreateCommandPool", name_);
    VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool_,
                                     VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    check(vkAllocateCommandBuffers(device.handle(), &info, &buffer_), "vkAllocateCommandBuffers", name_);
    VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vkCreateFence(device.handle(), &fence, nullptr, &fence_), "vkCreateFence", name_);
    VkQueryPoolCreateInfo query{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    query.queryType = VK_QUERY_TYPE_TIMESTAMP;
    query.queryCount = 2 * max_scopes_;
    check(vkCreateQueryPool(device.handle(), &query, nullptr, &timestamps_), "vkCreateQueryPool", name_);
    vkResetQueryPool(device.handle(), timestamps_, 0, query.queryCount);
    device.name_object(VK_OBJECT_TYPE_COMMAND_POOL, reinterpret_cast<uint64_t>(pool_), name_);
    device.name_object(VK_OBJECT_TYPE_COMMAND_BUFFER, reinterpret_cast<uint64_t>(buffer_), name_);
    device.name_object(VK_OBJECT_TYPE_FENCE, reinterpret_cast<uint64_t>(fence_), name_);
    device.name_object(VK_OBJECT_TYPE_QUERY_POOL, reinterpret_cast<uint64_t>(timestamps_), name_);
}

Commands::~Commands() {
    if (in_flight_) vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, UINT64_MAX);
    vkDestroyQueryPool(device_.handle(), timestamps_, nullptr);
    vkDestroyFence(device_.handle(), fence_, nullptr);
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

void Commands::begin() {
    assert(!in_flight_ && "begin() while the last submission is under way: wait() first");
    check(vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool", name_);
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vkBeginCommandBuffer(buffer_, &info), "vkBeginCommandBuffer", name_);
    // By the host, and only those that were written: the validation layers take milliseconds for a pool.
    const auto written = static_cast<uint32_t>(2 * scopes_.size());
    if (written > 0) vkResetQueryPool(device_.handle(), timestamps_, 0, written);
    scopes_.clear();
}

void Commands::submit(const CommandSemaphores& semaphores) {
    if (device_.used_debug_buffer() && !transfers_) host_barrier(*this);
    check(vkEndCommandBuffer(buffer_), "vkEndCommandBuffer", name_);
    VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    buffer.commandBuffer = buffer_;
    submitted_ = std::chrono::steady_clock::now();
    if (transfers_) {
        assert(!semaphores.wait && !semaphores.signal && "semaphores are for the main queue");
        number_ = transfers_->submit(buffer, fence_, name_);
    } else {
        submit_to_main_queue(buffer, semaphores);
    }
    in_flight_ = true;
}

void Commands::submit_to_main_queue(const VkCommandBufferSubmitInfo& buffer, const CommandSemaphores& semaphores) {
    constexpr VkPipelineStageFlags2 kStages =
        VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    std::array<VkSemaphoreSubmitInfo, 2> waits{};
    uint32_t wait_count = 0;
    if (semaphores.wait)
        waits[wait_count++] = {VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, semaphores.wait, 0, kStages, 0};
    const VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, semaphores.signal, 0,
                                       VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,    0};
    const std::lock_guard lock(device_.queue_mutex());
    TransferQueue* transfers = device_.transfer_queue();
    const std::optional<VkSemaphoreSubmitInfo> unseen = transfers ? transfers->unseen() : std::nullopt;
    if (unseen) waits[wait_count++] = *unseen;
    VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &buffer;
    info.waitSemaphoreInfoCount = wait_count;
    info.pWaitSemaphoreInfos = waits.data();
    info.signalSemaphoreInfoCount = semaphores.signal ? 1 : 0;
    info.pSignalSemaphoreInfos = &signal;
    check(vkQueueSubmit2(device_.queue(), 1, &info, fence_), "vkQueueSubmit2", name_);
    if (unseen) transfers->set_seen(unseen->value);
}

bool Commands::is_done() const {
    return !in_flight_ || vkGetFenceStatus(device_.handle(), fence_) != VK_NOT_READY;
}

void Commands::wait() {
    if (!in_flight_) return;
    {
        const TraceSpan span("wait for the device", name_);
        const VkResult result = vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, UINT64_MAX);
        const std::string pass = result == VK_ERROR_DEVICE_LOST ? unfinished_pass() : "";
        check(result, "vkWaitForFences", pass.empty() ? name_ : name_ + ", pass " + pass);
    }
    milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - submitted_).count();
    check(vkResetFences(device_.handle(), 1, &fence_), "vkResetFences", name_);
    in_flight_ = false;
    if (transfers_) return transfers_->set_finished(number_);
    if (is_tracing()) trace_passes();
    if (DebugBuffer* debug = device_.used_debug_buffer()) debug->report();
}

// Of a submission in which the device was lost: the last pass that had begun and not ended; empty: it is not known.
std::string Commands::unfinished_pass() const {
    struct Timestamp {
        uint64_t tick = 0, is_there = 0;
    };
    std::vector<Timestamp> all(2 * scopes_.size());
    if (all.empty()) return "";
    const VkResult result = vkGetQueryPoolResults(device_.handle(), timestamps_, 0, static_cast<uint32_t>(all.size()),
                                                  all.size() * sizeof(Timestamp), all.data(), sizeof(Timestamp),
                                                  VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
    if (result != VK_SUCCESS && result != VK_NOT_READY) return "";
    for (size_t i = scopes_.size(); i-- > 0;)
        if (all[2 * i].is_there && !all[2 * i + 1].is_there) return scopes_[i];
    return "";
}

// Those of the begin and the end of each timed scope.
std::vector<uint64_t> Commands::timestamps() const {
    std::vector<uint64_t> ticks(2 * scopes_.size());
    if (ticks.empty()) return ticks;
    check(vkGetQueryPoolResults(device_.handle(), timestamps_, 0, static_cast<uint32_t>(ticks.size()),
                                ticks.size() * sizeof(uint64_t), ticks.data(), sizeof(uint64_t),
                                VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "vkGetQueryPoolResults", name_);
    return ticks;
}

// The whole submission and its passes, on a lane of the device's own.
void Commands::trace_passes() const {
    const std::vector<uint64_t> ticks = timestamps();
    if (ticks.empty()) return;
    const auto nanoseconds = [&](uint64_t tick) {
        return DeviceClock::Ticks(static_cast<double>(tick) * static_cast<double>(device_.limits().timestampPeriod));
    };
    const auto [first, last] = std::ranges::minmax(ticks);
    device_.clock().learn(nanoseconds(last), TraceClock::now());
    const auto add = [&](const std::string& name, uint64_t begin, uint64_t end) {
        add_trace_span(device_.summary().name, name, device_.clock().host_time(nanoseconds(begin)),
                       device_.clock().host_time(nanoseconds(end)));
    };
    add(name_, first, last);
    for (size_t i = 0; i < scopes_.size(); ++i) add(scopes_[i], ticks[2 * i], ticks[2 * i + 1]);
}

double Commands::device_milliseconds() const {
    const std::vector<uint64_t> ticks = timestamps();
    if (ticks.empty()) return 0;
    const auto [first, last] = std::ranges::minmax(ticks);
    return static_cast<double>(last - first) * static_cast<double>(device_.limits().timestampPeriod) * 1e-6;
}

std::vector<PassTime> Commands::pass_times() const {
    const std::vector<uint64_t> ticks = timestamps();
    const double milliseconds_per_tick = static_cast<double>(device_.limits().timestampPeriod) * 1e-6;
    std::vector<PassTime> times;
    for (size_t i = 0; i < scopes_.size(); ++i)
        times.push_back({scopes_[i], static_cast<double>(ticks[2 * i + 1] - ticks[2 * i]) * milliseconds_per_tick});
    return times;
}

uint32_t Commands::begin_pass(const std::string& pass) {
    assert(!transfers_ && "passes are for the main queue");
    const auto index = static_cast<uint32_t>(scopes_.size());
    if (vkCmdBeginDebugUtilsLabelEXT) {
        const VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, nullptr, pass.c_str(), {}};
        vkCmdBeginDebugUtilsLabelEXT(buffer_, &label);
    }
    if (index < max_scopes_) {
        scopes_.push_back(pass);
        vkCmdWriteTimestamp2(buffer_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, timestamps_, 2 * index);
    }
    return index;
}

void Commands::end_pass(uint32_t index) {
    if (index < max_scopes_)
        vkCmdWriteTimestamp2(buffer_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, timestamps_, 2 * index + 1);
    if (vkCmdEndDebugUtilsLabelEXT) vkCmdEndDebugUtilsLabelEXT(buffer_);
}

namespace {

void bind(Commands& commands, const ComputePass& pass, const BindingSet& set, const void* push, size_t push_bytes) {
    assert(push_bytes == pass.interface().push_bytes && "push constants differ from the shader's");
    const VkDescriptorSet handle = set.handle();
    vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_COMPUTE, pass.pipeline());
    vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_COMPUTE, pass.layout(), 0, 1, &handle, 0,
                            nullptr);
    if (push_bytes > 0)
        vkCmdPushConstants(commands.handle(), pass.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                           static_cast<uint32_t>(push_bytes), push);
}

constexpr VkPipelineStageFlags2 kDeviceStages =
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkAccessFlags2 kDeviceWrites = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;

void memory_barrier(Commands& commands, VkPipelineStageFlags2 stages_after, VkAccessFlags2 access_after) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = kDeviceStages;
    barrier.srcAccessMask = kDeviceWrites;
    barrier.dstStageMask = stages_after;
    barrier.dstAccessMask = access_after;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands.handle(), &info);
}

}  // namespace

void dispatch(Commands& commands, const ComputePass& pass, const BindingSet& set, uint64_t threads, const void* push,
              size_t push_bytes) {
    assert(threads <= uint64_t{UINT32_MAX} && "more threads than shaders can number");
    dispatch_groups(commands, pass, set, groups_of(threads, pass.interface().group_threads), push, push_bytes);
}

void dispatch_groups(Commands& commands, const ComputePass& pass, const BindingSet& set, uint32_t groups,
                     const void* push, size_t push_bytes) {
    if (groups == 0) return;
    bind(commands, pass, set, push, push_bytes);
    // A device may allow as few as 65535 groups in a dimension, so groups fill rows: a shader computes the number of
    // its group as y * gl_NumWorkGroups.x + x.
    const VkPhysicalDeviceLimits& limits = commands.device().limits();
    const uint32_t columns = std::min(groups, limits.maxComputeWorkGroupCount[0]);
    const uint32_t rows = groups_of(groups, columns);
    assert(rows <= limits.maxComputeWorkGroupCount[1] && "more workgroups than the device dispatches");
    vkCmdDispatch(commands.handle(), columns, rows, 1);
}

void dispatch_indirect(Commands& commands, const ComputePass& pass, const BindingSet& set, const Buffer& arguments,
                       uint64_t offset, const void* push, size_t push_bytes) {
    bind(commands, pass, set, push, push_bytes);
    vkCmdDispatchIndirect(commands.handle(), arguments.buffer, offset);
}

void compute_barrier(Commands& commands) {
    memory_barrier(commands, kDeviceStages | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                   VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

void draw_barrier(Commands& commands) {
    memory_barrier(commands, VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                   VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT);
}

void host_barrier(Commands& commands) {
    memory_barrier(commands, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

void full_barrier(Commands& commands) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands.handle(), &info);
}

void fill(Commands& commands, const Buffer& buffer, uint32_t word, uint64_t bytes) {
    vkCmdFillBuffer(commands.handle(), buffer.buffer, 0, bytes, word);
}

void update(Commands& commands, const Buffer& buffer, const void* data, size_t bytes, uint64_t offset) {
    constexpr size_t kMost = 65536;  // of one command
    for (size_t done = 0; done < bytes; done += kMost)
        vkCmdUpdateBuffer(commands.handle(), buffer.buffer, offset + done, std::min(kMost, bytes - done),
                          static_cast<const char*>(data) + done);
}

void copy(Commands& commands, const Buffer& from, const Buffer& to, uint64_t bytes, uint64_t from_offset,
          uint64_t to_offset) {
    const VkBufferCopy region{from_offset, to_offset, bytes};
    vkCmdCopyBuffer(commands.handle(), from.buffer, to.buffer, 1, &region);
}

void run_once(const Device& device, const std::string& name, const std::function<void(Commands&)>& record) {
    Commands commands(device, name);
    commands.begin();
    record(commands);
    host_barrier(commands);
    commands.submit();
    commands.wait();
}

}  // namespace neuvv::gpu
