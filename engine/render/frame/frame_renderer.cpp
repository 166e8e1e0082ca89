#include "render/frame/frame_renderer.h"

#include <cassert>
#include <cstring>
#include <utility>

#include "base/trace_file.h"

namespace neuvv::render {

namespace {

// Three scopes for an instance, three more for its highlight, and five for its slice, for the views and again for the
// lights, and the other passes.
constexpr uint32_t kMaxScopes = 22 * kMaxInstances + 64;

}  // namespace

FrameRenderer::FrameRenderer(const gpu::Device& device, std::vector<const Field*> fields, const FrameCapacity& capacity,
                             SetRaster* set)
    : device_(device),
      recorder_(device, capacity, set),
      slices_(device, std::move(fields), capacity.slice_budget),
      queue_(device, kMaxScopes) {}

FrameRenderer::FrameRenderer(FrameRenderer&& other, const FrameCapacity& capacity)
    : FrameRenderer(other.device_, other.slices_.fields(), capacity, other.recorder_.set()) {
    other.finish();
    picks_.take_over(other.picks_);
    recorder_.take_over(other.recorder_);
    slices_.take_over(other.slices_, recorder_.performer_targets()[kEyeTarget]);
}

void FrameRenderer::change_fields(std::vector<const Field*> fields, uint32_t shares) {
    if (shares == 0) shares = static_cast<uint32_t>(fields.size());
    if (slices_.has_fields(fields, shares)) return;
    finish();
    slices_.change_fields(std::move(fields), shares);
    recorder_.forget_fields();
    plan_.drawn.clear();
}

void FrameRenderer::wait_for_device() {
    picks_.finish();
    queue_.wait_for_device();
}

// Whether the image of this slot, which must be finished, needed more room on the device than there was.
bool FrameRenderer::overflowed(uint32_t slot) const {
    return recorder_.intervals_overflowed(slot) || slices_.overflowed(slot);
}

// Makes more room for what had too little in finished images. No image may be under way.
void FrameRenderer::enlarge() {
    try {
        slices_.enlarge();
        recorder_.enlarge_intervals(slices_.performers());
    } catch (const gpu::VulkanError& error) {
        recorder_.drop_intervals();
        drop_slices_or_rethrow(error);
    }
}

bool FrameRenderer::drop_slices() {
    wait_for_device();
    queue_.forget();
    return slices_.drop();
}

// For a handler of the error.
void FrameRenderer::drop_slices_or_rethrow(const gpu::VulkanError& error) {
    if (error.device_lost()) throw;
    wait_for_device();
    queue_.forget();
    if (!slices_.drop_after(error)) throw;
}

void FrameRenderer::forget_slices() {
    finish();
    slices_.forget();
}

// Plans the image, and writes the cameras of views and instances, and the tiles of the views.
void FrameRenderer::aim(std::span<const stage::Camera> cameras, const FrameSettings& settings) {
    // First, as it may find no memory: then the tiles are still those of the plan.
    if (is_upscaled(settings)) recorder_.make_upscaler();
    const ViewLayout last = plan_.layout;
    plan_views(plan_, cameras, settings);
    const TargetViews views{recorder_.target(), plan_.layout, cameras, plan_.grids, settings.scale};
    write_cameras(views);
    if (plan_.layout != last) {
        wait_for_device();
        write_tiles(views);
    }
    plan_instances(plan_, views, settings, slices_.levels(), recorder_.set() != nullptr);
}

// Writes what the host writes for an image, creates what it needs on the device, and returns its settings with the
// levels at which instances are drawn.
FrameSettings FrameRenderer::begin(std::span<const stage::Camera> cameras, const FrameSettings& given) {
    if (!slices_.ensure_performers(recorder_.performer_targets(), given.far_levels)) {
        wait_for_device();
        slices_.free_far_levels();
    }
    FrameSettings settings = given;
    slices_.choose_far_levels(cameras, settings);
    aim(cameras, settings);
    const auto shadows = recorder_.plan_shadows(slices_.levels(), settings.instances);
    const SliceRequests requests = slice_requests(plan_, shadows, settings.next_instances, slices_.levels());
    if (slices_.replaces(requests)) wait_for_device();
    slices_.request(requests);
    recorder_.make_passes(plan_, settings, slices_);
    return settings;
}

FrameSettings FrameRenderer::begin_with_memory_left(std::span<const stage::Camera> cameras,
                                                    const FrameSettings& settings) {
    for (;;) {
        try {
            return begin(cameras, settings);
        } catch (const gpu::VulkanError& error) {
            drop_slices_or_rethrow(error);
        }
    }
}

void FrameRenderer::submit_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& given,
                              const Then& then) {
    recorder_.expect_room({given.width, given.height, given.samples, static_cast<uint32_t>(cameras.size()), {}});
    expect_drawable(cameras, given, slices_.levels().given());
    if (device_.used_debug_buffer()) finish();  // the host reads and empties it when an image is finished
    queue_.turn();
    if (!finish(queue_.slot())) {
        finish();
        enlarge();
    }
    const TraceSpan span("record a frame");
    const FrameSettings settings = begin_with_memory_left(cameras, given);
    recorder_.begin_intervals(queue_.slot());
    gpu::Commands& commands = queue_.commands();
    commands.begin();
    recorder_.record_frame({commands, queue_.slot(), plan_, settings, slices_.performers()});
    if (to == Destination::kHost) recorder_.record_readback(commands, plan_.layout);
    if (then) then(commands, recorder_.image());
    queue_.submit();
}

// Waits for the image of the slot. Returns false where it lacks parts: finish() must be called.
bool FrameRenderer::finish(uint32_t slot) {
    return !queue_.wait(slot) || !overflowed(slot);
}

bool FrameRenderer::finish() {
    bool whole = true;
    for (const uint32_t slot : queue_.oldest_first()) whole &= finish(slot);
    picks_.finish();
    if (!whole) enlarge();
    return whole;
}

void FrameRenderer::submit(std::span<const stage::Camera> cameras, const FrameSettings& settings, const Then& then) {
    submit_to(Destination::kDevice, cameras, settings, then);
}

void FrameRenderer::draw_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& settings,
                            const Then& then) {
    do submit_to(to, cameras, settings, then);
    while (!finish());
}

const gpu::Buffer& FrameRenderer::draw(std::span<const stage::Camera> cameras, const FrameSettings& settings,
                                       const Then& then) {
    draw_to(Destination::kDevice, cameras, settings, then);
    return recorder_.image();
}

std::vector<media::Image> FrameRenderer::render_views(std::span<const stage::Camera> cameras,
                                                      const FrameSettings& settings) {
    draw_to(Destination::kHost, cameras, settings, {});
    std::vector<media::Image> images;
    const uint8_t* from = recorder_.readback().as<uint8_t>();
    for (size_t view = 0; view < cameras.size(); ++view) {
        media::Image& image = images.emplace_back(settings.width, settings.height);
        std::memcpy(image.rgba.data(), from, image.rgba.size());
        from += image.rgba.size();
    }
    return images;
}

media::Image FrameRenderer::render(const stage::Camera& camera, const FrameSettings& settings) {
    return std::move(render_views({&camera, 1}, settings)[0]);
}

bool FrameRenderer::begin_pick(const Instance& instance, std::span<const PickRay> rays, float alpha) {
    const auto [performer, slice] = slices_.nearest_built(instance, kPickedNear);
    if (performer) picks_.begin(*performer, slice, rays, alpha);
    return performer != nullptr;
}

void FrameRenderer::read_intervals(const TakeIntervals& take) {
    finish();
    read_frame_intervals(device_, queue_, recorder_, plan_, slices_.performers(), take);
}

std::vector<glm::vec4> FrameRenderer::radiance(uint32_t view) const {
    assert(!queue_.any_under_way() && "finish() first");
    return rows_of_view<glm::vec4>(device_, target().rays.radiance, plan_.layout, view);
}

std::vector<float> FrameRenderer::depth(uint32_t view) const {
    assert(!queue_.any_under_way() && "finish() first");
    return rows_of_view<float>(device_, target().rays.depth, plan_.layout, view);
}

}  // namespace neuvv::render
