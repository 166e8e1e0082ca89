// Reference paths: a frame of one instance in one view, as the renderer that plays is measured and tested against it.
#pragma once

#include <memory>

#include "media/image.h"
#include "render/resolve.h"
#include "render/view_layout.h"

namespace neuvv::render {

enum class ReferencePath {
    kSlots,   // the slice as training has it, in slots of single precision
    kDirect,  // no slice: all numbers at each sample
    kPaper,   // the same, walking as the paper's renderer does: from the root to every cell
};

struct ReferenceSettings {
    ReferencePath path = ReferencePath::kDirect;
    float frame = 0;
    uint32_t samples = 1;     // rays a pixel, along each side
    ResolveSettings resolve;  // no inspection
    float stop = kStopTransmittance;
};

// Draws frames by any of the paths; what a path needs on the device is made when it is first asked for.
class ReferenceRenderer {
  public:
    // For images of at most so many pixels of samples × samples rays. The field must outlive the renderer.
    ReferenceRenderer(const gpu::Device& device, const Field& field, uint32_t width, uint32_t height,
                      uint32_t samples = 1);

    // Renders and waits. Throws RuntimeFailure for an image larger than the renderer was made for.
    media::Image render(const stage::Camera& camera, const ReferenceSettings& settings);

    // Rays of the last frame in rows (samples times as many a side): premultiplied linear RGB and alpha; metres.
    std::vector<glm::vec4> radiance() const;
    std::vector<float> depth() const;

    // GPU time of each pass of the last frame, and the time from its submission until it was there.
    std::vector<gpu::PassTime> pass_times() const { return commands_.pass_times(); }
    double milliseconds() const { return commands_.milliseconds(); }

  private:
    struct SlotPath {
        SlotPath(const gpu::Device& device, const Field& field, const RayBatch& rays);
        Slice slice;
        Slicer slicer;
        Tracer tracer;
    };
    struct DirectPath {
        DirectPath(const gpu::Device& device, const Field& field, const RayBatch& rays);
        LiveLeaves live;  // its rows alone
        LiveFinder finder;
        DirectTracer direct, paper;
    };
    void prepare(const stage::Camera& camera, const ReferenceSettings& settings);
    void record_path(const ReferenceSettings& settings);

    const gpu::Device& device_;
    const Field& field_;
    RayBatch rays_;
    gpu::Buffer image_, readback_;
    Resolver resolver_;
    std::unique_ptr<SlotPath> slots_;
    std::unique_ptr<DirectPath> direct_;
    ViewLayout layout_;  // of the last frame
    gpu::Commands commands_;
};

}  // namespace neuvv::render
