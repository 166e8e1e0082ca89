// A whole frame: the place to start reading.
#pragma once

#include <memory>
#include <optional>

#include "media/image.h"
#include "render/draw_order.h"
#include "render/image_list.h"
#include "render/inspect.h"
#include "render/performer_shadows.h"
#include "render/resolve.h"
#include "render/segments.h"
#include "render/volume_depth.h"

namespace neuvv::render {

enum class TraceMode {
    kPlay,    // slice trees, shaded where that shows the same (play_shading)
    kShaded,  // slice trees with one colour a leaf
    kTree,    // slice trees, SH along each ray
};

enum class Blend {
    kExact,  // instances whose boxes overlap along a ray are marched together, in depth order
    kPaper,  // each is a layer, blended by depth: the paper's Algorithm 1 (errata 11)
};

struct NextSlice {
    SliceKey slice;
    uint32_t field = 0;
};

struct FrameSettings {
    std::vector<Instance> instances = std::vector<Instance>(1);  // at most kMaxInstances
    uint32_t width = 0, height = 0;
    uint32_t samples = 1;                // rays a pixel, along each side: 2 averages four
    double scale = 1;                    // below 1: so many rays a pixel along each side, upscaled; samples must be 1
    std::vector<Fovea> foveae;           // one a view, or none; as scale
    std::vector<NextSlice> next_slices;  // that will be shown next, the first first: built ahead,
    uint32_t prefetch_parts = 2;         // so many of kSliceParts parts a slice with each image
    ResolveSettings resolve;             // an inspection: the set takes no part, nor do lights
    TraceMode mode = TraceMode::kTree;
    Blend blend = Blend::kExact;
    bool lit = true;  // the set's lights shine on performers, who else show what was captured
    float stop = kStopTransmittance;
};

constexpr uint32_t kMaxInstances = 512;

constexpr uint32_t kEyeTarget = 0, kLightTarget = 1;  // of each performer

// What a renderer is made for, at most.
struct FrameCapacity {
    uint32_t width = 0, height = 0;
    uint32_t samples = 1;
    uint32_t views = 1;
    uint64_t slice_budget =
        kSliceBudget;  // bytes, in equal shares for all fields; 0: no slices, all numbers at each sample
    uint64_t segment_budget = UINT64_MAX;  // bytes for those along rays that are merged at once
};

// Everything a frame needs on the device, made once.
class FrameRenderer {
  public:
    // `set`: what stands around the performers, of samples · width × samples · height texels and as many views at
    // least; its owner poses and lights it before each image.
    FrameRenderer(const gpu::Device& device, std::vector<const Field*> fields, const FrameCapacity& capacity,
                  SetRaster* set = nullptr);
    FrameRenderer(const gpu::Device& device, const Field& field, const FrameCapacity& capacity)
        : FrameRenderer(device, std::vector{&field}, capacity) {}
    // The other one for another size, on its set, which has been resized already: slices, paints and shadows with their
    // passes go over, what is bound to the images is made anew. The other one can only be destroyed afterwards.
    FrameRenderer(FrameRenderer&& other, const FrameCapacity& capacity);

    // Other fields, each once; those that stay keep their paints and, as long as there are as many, their slices. No
    // frame may be under way. Fields that go must live until this is done.
    void change_fields(std::vector<const Field*> fields);

    // Renders and waits; the images stay on the device: R8G8B8A8, sRGB with straight alpha, of each camera behind
    // each other in rows of settings.width, until the next one is drawn. Passes that read them elsewhere than in
    // compute shaders and copies begin with a barrier. Throws RuntimeFailure for more or larger images than the
    // renderer was made for, cameras of another size, fields that it has not, and transforms that cannot be inverted.
    const gpu::Buffer& draw(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    // The same, brought to the host.
    std::vector<media::Image> render_views(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    media::Image render(const stage::Camera& camera, const FrameSettings& settings);

    // What instances of a field may be painted with.
    Paints& paints(uint32_t field = 0) { return *paints_[field]; }

    // The next image slices anew, as if no frame had been shown yet (for measuring).
    void forget_slices();

    // Rays of the last image's view in rows (samples times as many a side): premultiplied linear RGB and alpha;
    // metres. Of an inspection what shared/inspect.h says.
    std::vector<glm::vec4> radiance(uint32_t view = 0) const;
    std::vector<float> depth(uint32_t view = 0) const;

    // What the last image left on the device; no performer before the first.
    const Performer* performer(uint32_t field = 0) const {
        return field < performers_.size() ? performers_[field].get() : nullptr;
    }
    // Live leaves, and the live nodes above them, of all slices that it shows; copies share theirs.
    uint64_t live_entries() const;
    const TileRanges& ranges() const { return target_.ranges; }
    const SetRaster* set() const { return set_; }  // null where there is none
    const gpu::Device& device() const { return device_; }
    const RayBatch& rays() const { return target_.rays; }
    // How they and the last image's pixels stand in their buffers.
    const ViewLayout& layout() const { return layout_; }
    // Instances by draw order, in groups that were merged (draw_order.h).
    std::span<const std::vector<DrawnInstance>> drawn() const { return drawn_; }

    // GPU time of each pass of the last image.
    std::vector<gpu::PassTime> pass_times() const { return commands_.pass_times(); }
    // From its submission until it was there (Commands::milliseconds).
    double milliseconds() const { return commands_.milliseconds(); }

  private:
    // The frame, pass by pass (frame.cpp), and its images to the host.
    void record_frame(const FrameSettings& settings);
    void record_readback();
    void record_playing(const FrameSettings& settings);
    void record_inspected(const FrameSettings& settings);
    void record_blank(const FrameSettings& settings);
    void record_listed();
    void record_rays(const FrameSettings& settings);
    void record_merged(std::span<const DrawnInstance> group, const FrameSettings& settings);
    enum class Destination { kDevice, kHost };
    void draw_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& settings);
    void check_settings(std::span<const stage::Camera> cameras, const FrameSettings& settings) const;
    void make_grids(const FrameSettings& settings, uint32_t views);
    TargetViews views_of(std::span<const stage::Camera> cameras, const FrameSettings& settings) const;
    void write_rays(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    void write_instances(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    std::vector<std::vector<uint32_t>> instance_order(std::span<const stage::Camera> cameras,
                                                      const FrameSettings& settings) const;
    void prepare(const FrameSettings& settings);
    bool enlarge();
    const gpu::Device& device_;
    std::vector<const Field*> fields_;
    FrameCapacity capacity_;
    SetRaster* set_;
    RayTarget target_;
    gpu::Buffer image_, readback_;
    gpu::Buffer blank_;  // what images show where nothing is seen
    std::optional<std::pair<ViewLayout, ResolveSettings>> blank_key_;
    std::vector<std::unique_ptr<Paints>> paints_;         // by field
    std::vector<std::unique_ptr<Performer>> performers_;  // by field; paths are made when first asked for
    std::unique_ptr<Segments> segments_;
    ImageLister lister_;
    Resolver resolver_, listed_resolver_;        // of all tiles; of those where anything may be seen
    std::unique_ptr<Resolver> upscaler_;         // made when first asked for
    std::unique_ptr<Inspector> inspector_;       // likewise
    std::unique_ptr<PerformerShadows> shadows_;  // where there is a set
    std::unique_ptr<VolumeDepth> volume_depth_;
    std::vector<stage::Camera> set_cameras_;
    ViewLayout layout_;                              // of the last image
    std::vector<RayGrid> grids_;                     // of its views, where they are upscaled
    std::vector<std::vector<DrawnInstance>> drawn_;  // of the last image: those that may be seen, near to far
    gpu::Commands commands_;
};

}  // namespace neuvv::render
