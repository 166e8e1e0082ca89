// A whole frame of one performer: the place to start reading.
#pragma once

#include <memory>
#include <optional>

#include "media/image.h"
#include "render/resolve.h"
#include "render/shade.h"
#include "render/trace_tree.h"

namespace neuvv {

enum class TraceMode {
    kShaded,  // slice tree with one colour a leaf: for playing
    kTree,    // slice tree, SH along each ray
    kSlice,   // the slice as training has it, in single precision
    kDirect,  // no slice: all numbers at each sample
    kPaper,   // the same, walking as the paper's renderer does: from the root to every cell
};

// kShaded where that shows the same: where leaves are small, seen from the eye (world, metres), on the average. Else
// kTree.
TraceMode play_mode(const Field& field, glm::vec3 eye);

struct FrameSettings {
    float frame = 0;  // of the clip, 0..frames−1, fractions allowed
    uint32_t width = 0, height = 0;
    uint32_t samples = 1;  // rays a pixel, along each side: 2 averages four
    ResolveSettings resolve;
    TraceMode mode = TraceMode::kTree;
    float stop = kStopTransmittance;
};

// What each way of tracing needs on the device besides rays.
struct SlotPath {
    SlotPath(const Device& device, const Field& field, const RayBatch& rays);
    Slice slice;
    Slicer slicer;
    Tracer tracer;
};

struct TreePath {
    // Room for as many slices of `entries` entries as the budget allows, one at least.
    TreePath(const Device& device, const Field& field, const RayBatch& rays, const Buffer& picture, uint32_t entries,
             uint64_t slice_budget);
    // Where the slice of a frame is: `built`, or where it shall be, in place of the one that was not asked for for
    // longest.
    struct Place {
        uint32_t slice;
        bool built;
    };
    Place place_of(float frame);

    LiveLeaves live;
    SliceTrees trees;
    Buffer shaded;
    TileRanges ranges;
    TreeSlicer slicer;
    Shader shader;
    TileRanger ranger;
    TreeTracer unshaded_tracer, shaded_tracer;
    Resolver resolver;  // of tiles that see anything; `blank` is what the others show
    Buffer blank;
    std::optional<FrameSettings> blank_settings;
    struct Kept {
        std::optional<float> frame;
        uint64_t asked = 0;  // the last time, in pictures
    };
    std::vector<Kept> kept;  // per slice
    uint64_t pictures = 0;
    Buffer count_readback;  // LiveCount of the last picture's slice
};

struct DirectPath {
    DirectPath(const Device& device, const Field& field, const RayBatch& rays);
    LiveLeaves live;  // its rows alone
    LiveFinder finder;
    DirectTracer direct, paper;
};

// Bytes that slices of frames may take on the device, however many frames are shown: those shown last are kept.
constexpr uint64_t kSliceBudget = uint64_t{256} << 20;

// Everything a frame needs on the device, made once for the largest picture.
class FrameRenderer {
  public:
    FrameRenderer(const Device& device, const Field& field, uint32_t max_width, uint32_t max_height,
                  uint32_t max_samples = 1, uint64_t slice_budget = kSliceBudget);

    // Renders and waits: the picture, sRGB with straight alpha. `camera` is that of the picture. Throws RuntimeFailure
    // for a picture larger than the renderer was made for.
    Image render(const Camera& camera, const FrameSettings& settings);

    // The next picture slices anew, as if no frame had been shown yet (for measuring).
    void forget_slices();

    // Rays of the last picture in rows (samples times as many a side): premultiplied linear RGB and alpha; metres.
    std::vector<glm::vec4> radiance(uint32_t width, uint32_t height) const;
    std::vector<float> depth(uint32_t width, uint32_t height) const;

    // What slice trees have on the device, the last one shaded if its picture was; null before the first.
    const TreePath* tree_path() const { return tree_.get(); }

    // GPU time of each pass of the last picture.
    std::vector<PassTime> pass_times() const { return commands_.pass_times(); }

  private:
    friend void record_frame(Commands& commands, FrameRenderer& renderer, const ShaderCamera& camera,
                             const FrameSettings& settings);
    friend void record_tree(Commands& commands, FrameRenderer& renderer, const ShaderCamera& camera,
                            const FrameSettings& settings);
    void prepare(TraceMode mode);
    bool enlarge_slices();
    const Device& device_;
    const Field& field_;
    uint64_t slice_budget_;
    RayBatch rays_;
    Buffer picture_, readback_;
    std::unique_ptr<SlotPath> slots_;  // each made when first asked for
    std::unique_ptr<TreePath> tree_;
    std::unique_ptr<DirectPath> direct_;
    Resolver resolver_;
    Commands commands_;
};

// The frame, pass by pass. Camera and tiles are already in the ray batch, the mode's path is made.
void record_frame(Commands& commands, FrameRenderer& renderer, const ShaderCamera& camera,
                  const FrameSettings& settings);

}  // namespace neuvv
