// Reference paths: other ways to draw one instance in one view, against which FrameRenderer is measured and tested.
#pragma once

#include <memory>

#include "media/image.h"
#include "render/rays/resolve.h"
#include "render/rays/view_layout.h"
#include "render/volume/trace.h"

namespace neuvv::render {

enum class ReferencePath {
    kSlots,   // the slice of training: slots in single precision
    kDirect,  // no slice: all numbers of a leaf at each sample
    kPaper,   // the same, walking as the paper's renderer does: from the root to every cell
};

struct ReferenceSettings {
    ReferencePath path = ReferencePath::kDirect;
    float frame = 0;
    uint32_t samples = 1;     // rays per pixel along each side
    ResolveSettings resolve;  // not an inspection
    float stop = kStopTransmittance;
};

// Draws frames by any of the paths. What a path needs on the device is created when it is first used.
class ReferenceRenderer {
  public:
    // For images of at most width × height pixels with samples × samples rays each. The field must outlive the
    // renderer. Throws RuntimeFailure where the device cannot address so many rays.
    ReferenceRenderer(const gpu::Device& device, const Field& field, uint32_t width, uint32_t height,
                      uint32_t samples = 1);

    // Renders and waits. Throws RuntimeFailure for an image that is larger than the constructor allowed.
    media::Image render(const stage::Camera& camera, const ReferenceSettings& settings);

    // The rays of the last frame, in rows of samples · width: premultiplied linear RGB and alpha; depth in metres.
    std::vector<glm::vec4> radiance() const;
    std::vector<float> depth() const;

    // GPU time of each pass of the last frame, and the time from its submission until it was finished.
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
        LiveLeaves live;  // only its rows are used
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
