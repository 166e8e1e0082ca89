// A whole frame of one performer: the place to start reading.
#pragma once

#include "media/image.h"
#include "render/resolve.h"
#include "render/slice.h"
#include "render/trace.h"

namespace neuvv {

enum class TraceMode { kSlice, kDirect };  // kDirect: the paper's path, all numbers at each sample

struct FrameSettings {
    float frame = 0;  // of the clip, 0..frames−1, fractions allowed
    uint32_t width = 0, height = 0;
    uint32_t samples = 1;  // rays a pixel, along each side: 2 averages four
    ResolveSettings resolve;
    TraceMode mode = TraceMode::kSlice;
    float stop = kStopTransmittance;
};

// Everything a frame needs on the device, made once for the largest picture.
class FrameRenderer {
  public:
    FrameRenderer(const Device& device, const Field& field, uint32_t max_width, uint32_t max_height,
                  uint32_t max_samples = 1);

    // Renders and waits: the picture, sRGB with straight alpha. `camera` is that of the picture. Throws RuntimeFailure
    // for a picture larger than the renderer was made for.
    Image render(const Camera& camera, const FrameSettings& settings);

    // Rays of the last picture in rows (samples times as many a side): premultiplied linear RGB and alpha; metres.
    std::vector<glm::vec4> radiance(uint32_t width, uint32_t height) const;
    std::vector<float> depth(uint32_t width, uint32_t height) const;

    // GPU time of each pass of the last picture.
    std::vector<PassTime> pass_times() const { return commands_.pass_times(); }

  private:
    friend void record_frame(Commands& commands, FrameRenderer& renderer, const FrameSettings& settings);
    const Device& device_;
    Slice slice_;
    RayBatch rays_;
    Buffer picture_, readback_;
    Slicer slicer_;
    Tracer tracer_;
    DirectTracer direct_;
    Resolver resolver_;
    Commands commands_;
};

// The frame, pass by pass. Camera and tiles are already in the ray batch.
void record_frame(Commands& commands, FrameRenderer& renderer, const FrameSettings& settings);

}  // namespace neuvv
