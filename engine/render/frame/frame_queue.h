// Frame queue: the frames that are under way, each in a slot.
#pragma once

#include <algorithm>
#include <array>
#include <functional>

#include "gpu/commands.h"
#include "render/rays/ray_target.h"

namespace neuvv::render {

// Owns the commands of each slot, and what is known of the frame in it. A slot has one frame at a time: it is under way
// from submit() until somebody has waited for it. What a frame reads may be written on the host, or freed, after
// wait_for_device() alone.
class FrameQueue {
  public:
    // `scopes`: the largest number of PassScopes in a frame.
    FrameQueue(const gpu::Device& device, uint32_t scopes);

    // The slot of the last frame, and its commands.
    uint32_t slot() const { return slot_; }
    gpu::Commands& commands() { return commands_[slot_]; }
    const gpu::Commands& commands() const { return commands_[slot_]; }
    // The slots, that of the oldest frame first.
    std::array<uint32_t, kImagesUnderWay> oldest_first() const;
    // Turns to the slot of the oldest frame, which becomes that of the next one. It must be waited for before its
    // commands begin.
    void turn() { slot_ = oldest_first()[0]; }
    // Submits the commands, which were begun and recorded.
    void submit();
    // Records work that is no frame into the slot, and waits for it. No frame may be under way. The times are then
    // those of this work.
    void run(const std::function<void(gpu::Commands& commands)>& record);

    // Waits for the slot. Returns whether a frame was under way in it until now; the times are then those of this
    // frame.
    bool wait(uint32_t slot);
    // Waits for the device alone: frames stay under way.
    void wait_for_device();
    // Nobody will wait for the frames that are under way. The device must have finished them.
    void forget() { under_way_ = {}; }
    bool any_under_way() const { return std::ranges::find(under_way_, true) != under_way_.end(); }

    // Of the last frame that somebody has waited for: time from its submission until then (Commands::milliseconds); the
    // device's time, which on software devices is the former.
    double milliseconds() const { return milliseconds_; }
    double device_milliseconds() const { return device_milliseconds_; }

  private:
    void note_times(const gpu::Commands& commands);
    bool is_software_;
    uint32_t slot_ = 0;
    std::array<gpu::Commands, kImagesUnderWay> commands_;  // by slot
    std::array<bool, kImagesUnderWay> under_way_{};        // likewise
    double milliseconds_ = 0, device_milliseconds_ = 0;
};

}  // namespace neuvv::render
