// What shaders print and assert (shaders/debug.glsl). A device creates the buffer when the first pass binds it.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "gpu/buffer.h"
#include "shared/debug.h"

namespace neuvv::gpu {

class DebugBuffer {
  public:
    explicit DebugBuffer(const Device& device);

    const Buffer& buffer() const { return buffer_; }

    // Returns the records that finished work has appended since the last call, at most kMaxDebugRecords, in no
    // particular order. `lost` is set to the number of further records, for which there was no room.
    std::vector<DebugRecord> drain(uint64_t& lost);
    // Passes drained records to the sink of shader messages, if one is set. Commands::wait() calls this.
    void report();

  private:
    std::mutex mutex_;
    Buffer buffer_;
};

// "assertion 41 failed at (3, 0, 0): 7 0 0 0 (1.4e-45 0 0 0)": the words as numbers and as floats.
std::string text_of(const DebugRecord& record);

// Sets the function that receives the messages of shaders on all devices of the program, one line each, after the work
// that wrote them was waited for. Any thread that waits for a device calls it, so it must be set before there is a
// device. Without a sink the records stay in the buffer until drain().
void set_shader_message_sink(std::function<void(const std::string& line)> sink);

}  // namespace neuvv::gpu
