// Frame renderer: draws frames. What a frame is made of is in frame_recorder.cpp.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "media/image.h"
#include "render/frame/frame_intervals.h"
#include "render/frame/frame_plan.h"
#include "render/frame/frame_queue.h"
#include "render/frame/frame_recorder.h"
#include "render/frame/frame_settings.h"
#include "render/frame/slice_picks.h"
#include "render/frame/slice_residency.h"

namespace neuvv::render {

// Everything that a frame needs on the device, created once. It ties its parts together in that it waits for the device
// before slices, intervals or what is planned for a frame are replaced, and draws again what had no room. Where an
// image needs more memory than the device has left, slices are dropped, and from then on fewer are kept; then far
// levels. Where even that is not enough, what draws the image throws VulkanError, and later images may be drawn again.
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

    // The rays of a view of the last image, in rows of plan().layout.rays_across(): premultiplied linear RGB and alpha;
    // depth along the ray in metres. After an inspection they hold what shared/inspect.h says.
    std::vector<glm::vec4> radiance(uint32_t view = 0) const;
    std::vector<float> depth(uint32_t view = 0) const;

    // read_frame_intervals() of the last image. Afterwards radiance() and depth() hold nothing, and the times are those
    // of this work. Throws as draw() does.
    void read_intervals(const TakeIntervals& take);

    // What the last image left of each field on the device.
    const SliceResidency& slices() const { return slices_; }
    // The number of live leaves and of live nodes above them, in all slices that the last image used.
    uint64_t live_entries() const { return slices_.live_entries(queue_.slot()); }
    // What the last image drew.
    const FramePlan& plan() const { return plan_; }
    // What its rays were traced into.
    const RayTarget& target() const { return recorder_.target(); }
    const SetRaster* set() const { return recorder_.set(); }  // null where there is none
    const gpu::Device& device() const { return device_; }

    // Of the last image, with no other under way: GPU time of each pass.
    std::vector<gpu::PassTime> pass_times() const { return queue_.commands().pass_times(); }
    // Of the last image that somebody has waited for (FrameQueue).
    double milliseconds() const { return queue_.milliseconds(); }
    double device_milliseconds() const { return queue_.device_milliseconds(); }

  private:
    enum class Destination { kDevice, kHost };
    void draw_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& settings,
                 const Then& then);
    void submit_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& settings,
                   const Then& then);
    FrameSettings begin(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    FrameSettings begin_with_memory_left(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    void aim(std::span<const stage::Camera> cameras, const FrameSettings& settings);
    void drop_slices_or_rethrow(const gpu::VulkanError& error);
    bool overflowed(uint32_t slot) const;
    void enlarge();
    bool finish(uint32_t slot);
    void wait_for_device();
    const gpu::Device& device_;
    FrameRecorder recorder_;
    SliceResidency slices_;
    FramePlan plan_;  // of the last image
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
