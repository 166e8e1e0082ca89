#include "render/frame/frame_queue.h"

#include <cassert>
#include <utility>

#include "gpu/device.h"

namespace neuvv::render {

FrameQueue::FrameQueue(const gpu::Device& device, uint32_t scopes)
    : is_software_(device.summary().kind == "cpu"),
      commands_{gpu::Commands(device, "frame", scopes), gpu::Commands(device, "frame", scopes)} {}

std::array<uint32_t, kImagesUnderWay> FrameQueue::oldest_first() const {
    std::array<uint32_t, kImagesUnderWay> slots{};
    for (uint32_t i = 0; i < kImagesUnderWay; ++i) slots[i] = (slot_ + 1 + i) % kImagesUnderWay;
    return slots;
}

void FrameQueue::submit() {
    commands().submit();
    under_way_[slot_] = true;
}

void FrameQueue::run(const std::function<void(gpu::Commands& commands)>& record) {
    assert(!any_under_way());
    commands().begin();
    record(commands());
    commands().submit();
    commands().wait();
    note_times(commands());
}

bool FrameQueue::wait(uint32_t slot) {
    commands_[slot].wait();
    if (!std::exchange(under_way_[slot], false)) return false;
    note_times(commands_[slot]);
    return true;
}

void FrameQueue::wait_for_device() {
    for (gpu::Commands& commands : commands_) commands.wait();
}

// The timestamps of software devices leave compute passes out where a submission also draws.
void FrameQueue::note_times(const gpu::Commands& commands) {
    milliseconds_ = commands.milliseconds();
    device_milliseconds_ = is_software_ ? milliseconds_ : commands.device_milliseconds();
}

}  // namespace neuvv::render
