// A capture by RenderDoc of everything that is submitted to a device while the object exists.
//
//   renderdoccmd capture build/release/neuvv render clip.nvv -o still.png --frames 0 --capture
//
// The program never loads RenderDoc's library: it uses the library where the program was started under RenderDoc.
#pragma once

#include <string>

#include "gpu/device.h"

struct RENDERDOC_API_1_6_0;

namespace neuvv::gpu {

class FrameCapture {
  public:
    // Waits for the device and begins the capture. Throws InputError where the program does not run under RenderDoc.
    explicit FrameCapture(const Device& device);
    // Discards the capture unless finish() has ended it.
    ~FrameCapture();
    FrameCapture(const FrameCapture&) = delete;
    FrameCapture& operator=(const FrameCapture&) = delete;

    // Waits for the device and ends the capture. Returns the path of the capture's file. Throws RuntimeFailure where
    // RenderDoc could not write the file.
    std::string finish();

  private:
    const Device& device_;
    RENDERDOC_API_1_6_0* api_;
    bool capturing_ = false;
};

}  // namespace neuvv::gpu
