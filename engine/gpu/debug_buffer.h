// What shaders print and assert (shaders/debug.glsl). A device makes the buffer when the first pass wants it.
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

    // What was appended since the last call, of work that was waited for; at most kMaxDebugRecords, in no order.
    // `lost`: how many more found no room.
    std::vector<DebugRecord> drain(uint64_t& lost);
    // Drains into the sink of shader messages, where there is one. Commands::wait() calls it.
    void report();

  private:
    std::mutex mutex_;
    Buffer buffer_;
};

// "assertion 41 failed at (3, 0, 0): 7 0 0 0 (1.4e-45 0 0 0)": the words as numbers and as floats.
std::string text_of(const DebugRecord& record);

// Where what shaders say is told, a line each, as soon as their work was waited for: for all devices of the program.
// Without a sink the records stay until drain(). Called by any thread that waits for a device; set before there is one.
void set_shader_message_sink(std::function<void(const std::string& line)> sink);

}  // namespace neuvv::gpu
