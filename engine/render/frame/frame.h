// A whole frame: start reading here and in frame.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "media/image.h"
#include "render/frame/frame_queue.h"
#include "render/frame/frame_settings.h"
#include "render/frame/slice_picks.h"
#include "render/frame/slice_residency.h"
#include "render/rays/clear_rays.h"
#include "render/rays/image_list.h"
#include "render/rays/ray_intervals.h"
#include "render/volume/draw_order.h"
#include "render/volume/inspect.h"
#include "render/volume/intervals.h"
#include "render/volume/performer_shadows.h"
#include "render/volume/volume_depth.h"

namespace neuvv::render {

// Everything that a frame needs on the device, created once. Where an image needs more memory than the device has left,
// slices are dropped, and from then on fewer are kept; then far levels. Where even that is not enough, what draws the
// image throws VulkanError, and later images may be drawn again.
class FrameRenderer {
  public:
    // `set` is drawn with the performers. It must have at least samples · width × samples · height texels and as many
    // views as `capacity`; its owner poses and lights it before each image. All arguments must outlive the renderer.
    FrameRenderer(const gpu::Device& device, std::vector<const Field*> fields, const FrameCapacity& capacity,
                  SetRaster* set = nullptr);
    FrameRenderer(const gpu::Device& device, const Field& field, const FrameCapacity& capacity)
        : FrameRenderer(device, std::vector{&field}, capacity) {}
    // Takes over another renderer for another size. Its set must have been resized already. Slices, paints and shadows
    // with their passes move to the new renderer; passes that are bound to the images are created again. The other
    // renderer can only be destroyed afterwards.
    FrameRenderer(FrameRenderer&& other, const FrameCapacity& capacity);

    // Replaces the fields; each may occur only once. FrameCapacity::slice_budget is divided into `shares` from now on;
    // 0: into as many as there are fields. Fields that stay keep their paints, and also their slices where the shares
    // are as large as before. No frame may be under way. Fields that are removed must exist until the call returns.
    void change_fields(std::vector<const Field*> fields, uint32_t shares = 0);

    // Renders an image for each camera and waits. The images stay on the device until the next call: R8G8B8A8, sRGB
    // with straight alpha, in rows of settings.width pixels, the images of the cameras one after the other. A pass that
    // reads them, unless it is a compute shader or a copy, must begin with a barrier. Throws RuntimeFailure for more or
    // larger images than the capacity, more than kMaxInstances instances, cameras of another size than the images,
    // fields that the renderer does not have, frames that are not finite, and transforms that cannot be inverted.
    // `then` is recorded behind the images, into the same submission; it is recorded again where the images are.
    using Then = std::function<void(gpu::Commands& commands, const gpu::Buffer& images)>;
    const gpu::Buffer& draw(std::span<const stage::Camera> cameras, const FrameSettings& settings,
                            const Then& then = {});
    // The same without waiting: the host can do other work meanwhile, and record the next image while the device draws
    // this one. The image before may be under way when it returns, but none before that; what `then` writes on the host
    // needs kImagesUnderWay places. All that changes what a frame reads waits for it first, in this object by itself;
    // whoever changes something else that `then` or the instances refer to must call finish() before. An image that
    // lacks parts, as it needed more room on the device than there was, is found one image late.
    void submit(std::span<const stage::Camera> cameras, const FrameSettings& settings, const Then& then = {});
    // Waits for all that was submitted. Returns false where some of it lacks parts; there is more room now.
    bool finish();
    // The same as draw(), with the images copied to the host.
    std::vector<media::Image> render_views(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    media::Image render(const stage::Camera& camera, const FrameSettings& settings);

    // The paints for the instances of a field.
    Paints& paints(uint32_t field = 0) { return slices_.paints(field); }

    // Has the device find, after the images that are under way, where rays meet the surface of an instance (`alpha` as
    // for SlicePicker::pick), in the slice that images have left of it whose time is nearest to the instance's. The
    // rays are in the performer's space, at most 64 (assert). Returns false where there is no slice within kPickedNear
    // frames of its clip. It builds no slice, so that it may be called between two images of a stage that plays.
    bool begin_pick(const Instance& instance, std::span<const PickRay> rays, float alpha);
    static constexpr float kPickedNear = 3;
    // The results of the calls that returned true since the last take_picks(), in their order. It waits for them, but
    // for no image that was submitted after them.
    std::vector<std::vector<Picked>> take_picks() { return picks_.take(); }

    // Drops all slices, so that the next image builds them again (for measuring).
    void forget_slices();
    // Frees all slices, so that there is memory for something else. The next image builds those again that it needs;
    // from then on, slices may take half as much memory as before, or that of one slice of each field. Returns whether
    // there were any.
    bool drop_slices();
    // The bytes that slices may take now; 1: one slice of each field.
    uint64_t slice_budget() const { return slices_.budget(); }

    // The rays of a view of the last image, in rows of layout().rays_across(): premultiplied linear RGB and alpha;
    // depth along the ray in metres. After an inspection they hold what shared/inspect.h says.
    std::vector<glm::vec4> radiance(uint32_t view = 0) const;
    std::vector<float> depth(uint32_t view = 0) const;

    // Traces the rays of the last image once more, which must have had one view without upscaling and must be finished,
    // and calls `take` with the intervals of each ray that has any, tile by tile. `ray` is its place in the rows of
    // radiance(). Afterwards radiance() and depth() hold nothing, and the times are those of this work. Throws as
    // draw() does.
    using TakeIntervals = std::function<void(glm::uvec2 ray, std::span<const RayInterval> intervals)>;
    void read_intervals(const TakeIntervals& take);

    // What the last image left on the device, of a field that was given, without its coarser levels. Null before the
    // first image.
    const Performer* performer(uint32_t field = 0) const { return slices_.performer(field); }
    // The number of live leaves and of live nodes above them, in all slices that the last image used. Instances of a
    // field at the same time share a slice.
    uint64_t live_entries() const { return slices_.live_entries(queue_.slot()); }
    const TileRanges& ranges() const { return target_.ranges; }
    const SetRaster* set() const { return set_; }  // null where there is none
    const gpu::Device& device() const { return device_; }
    const RayBatch& rays() const { return target_.rays; }
    // The layout of the rays and of the pixels of the last image in their buffers.
    const ViewLayout& layout() const { return layout_; }
    // The visible instances of the last image in draw order, in groups that were merged (draw_order.h).
    std::span<const std::vector<DrawnInstance>> drawn() const { return drawn_; }

    // Of the last image, with no other under way: GPU time of each pass.
    std::vector<gpu::PassTime> pass_times() const { return queue_.commands().pass_times(); }
    // Of the last image that somebody has waited for: time from its submission until then (Commands::milliseconds); the
    // device's time, which on software devices is the former.
    double milliseconds() const { return queue_.milliseconds(); }
    double device_milliseconds() const { return queue_.device_milliseconds(); }

  private:
    // Record the frame, pass by pass (frame.cpp), and the copy of its images to the host.
    void record_frame(const FrameSettings& settings);
    void record_readback();
    void record_playing(const FrameSettings& settings);
    void record_inspected(const FrameSettings& settings);
    void record_blank(const FrameSettings& settings);
    void record_rays(const FrameSettings& settings);
    void record_merged(std::span<const DrawnInstance> group, const FrameSettings& settings);
    void record_intervals(std::span<const DrawnInstance> instances, const TileSpan& tiles, const gpu::Buffer& heads);
    void take_band(std::span<const DrawnInstance> instances, const TileSpan& tiles, const gpu::Buffer& heads,
                   const TakeIntervals& take) const;
    Intervals& intervals();
    enum class Destination { kDevice, kHost };
    void draw_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& settings,
                 const Then& then);
    FrameSettings begin(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    FrameSettings begin_with_memory_left(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    void drop_slices_or_rethrow(const gpu::VulkanError& error);
    std::vector<PerformerTarget> performer_targets() const;
    SliceRequests slice_requests(std::span<const Instance> next) const;
    void submit_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& settings,
                   const Then& then);
    void check_settings(std::span<const stage::Camera> cameras, const FrameSettings& settings) const;
    void make_grids(const FrameSettings& settings, uint32_t views);
    TargetViews views_of(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    void write_rays(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    void write_instances(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    std::vector<std::vector<uint32_t>> instance_order(std::span<const stage::Camera> cameras,
                                                      const FrameSettings& settings) const;
    void prepare(const FrameSettings& settings);
    bool overflowed(uint32_t slot) const;
    void enlarge();
    gpu::Commands& commands() { return queue_.commands(); }
    bool finish(uint32_t slot);
    void wait_for_device();
    const gpu::Device& device_;
    FrameCapacity capacity_;
    SetRaster* set_;
    RayTarget target_;
    gpu::Buffer image_, readback_;
    // What image_ was drawn for, outside the tiles that target_.ranges.image_shown marks; nothing: it is to be drawn
    // anew.
    std::optional<std::pair<ViewLayout, ResolveSettings>> blank_key_;
    RayClearer clearer_;
    SliceResidency slices_;
    std::unique_ptr<Intervals> intervals_;
    ImageLister lister_;
    Resolver resolver_, listed_resolver_;        // of all tiles; of the listed tiles
    std::unique_ptr<Resolver> upscaler_;         // created when first needed
    std::unique_ptr<Inspector> inspector_;       // likewise
    std::unique_ptr<PerformerShadows> shadows_;  // where there is a set
    std::unique_ptr<VolumeDepth> volume_depth_;
    std::vector<stage::Camera> set_cameras_;
    ViewLayout layout_;                              // of the last image
    std::vector<RayGrid> grids_;                     // of its views, where it is upscaled
    std::vector<std::vector<DrawnInstance>> drawn_;  // of the last image: the visible ones, near to far
    SlicePicks picks_;
    FrameQueue queue_;  // last, as its destructor waits for what reads the others
};

// Does something beside a renderer that needs memory on its device. Where there is none left, it is done again without
// the renderer's slices.
template <typename Work>
auto with_memory_of_slices(FrameRenderer& renderer, const Work& work) {
    try {
        return work();
    } catch (const gpu::VulkanError& error) {
        if (!error.out_of_memory() || !renderer.drop_slices()) throw;
    }
    return work();
}

}  // namespace neuvv::render
