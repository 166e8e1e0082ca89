// A capture by RenderDoc of all that is submitted to a device while the object lives.
//
//   renderdoccmd capture build/release/neuvv render clip.nvv -o still.png --frames 0 --capture
//
// RenderDoc's library is used where the program was started under RenderDoc, and never loaded otherwise.
#pragma once

#include <string>

#include "gpu/device.h"

struct RENDERDOC_API_1_6_0;

namespace neuvv::gpu {

class FrameCapture {
  public:
    // Throws InputError where the program does not run under RenderDoc.
    explicit FrameCapture(const Device& device);
    // Ends a capture that finish() has not ended, and throws it away.
    ~FrameCapture();
    FrameCapture(const FrameCapture&) = delete;
    FrameCapture& operator=(const FrameCapture&) = delete;

    // Ends the capture, after waiting for the device. Returns the file it is written to. Throws RuntimeFailure where
    // RenderDoc could not write it.
    std::string finish();

  private:
    const Device& device_;
    RENDERDOC_API_1_6_0* api_;
    bool capturing_ = false;
};

}  // namespace neuvv::gpu
