// FrameRenderer: submits images and waits for them. What had no room in one has it in a later one.
#include <algorithm>
#include <cstring>
#include <utility>

#include "base/trace_file.h"
#include "render/frame/frame.h"

namespace neuvv::render {

// Whether the image of this slot, which must be finished, needed more room on the device than there was.
bool FrameRenderer::overflowed(uint32_t slot) const {
    return (intervals_ && intervals_->overflowed(slot)) || slices_.overflowed(slot);
}

// Makes more room for what had too little in finished images. No image may be under way.
void FrameRenderer::enlarge() {
    try {
        slices_.enlarge();
        bool any = false;
        for (uint32_t slot = 0; intervals_ && slot < kImagesUnderWay; ++slot) any |= intervals_->overflowed(slot);
        if (any) {
            for (const auto& performer : slices_.performers())
                if (performer) performer->forget_intervals();
            intervals_->enlarge();
        }
    } catch (const gpu::VulkanError& error) {
        intervals_.reset();
        drop_slices_or_rethrow(error);
    }
}

void FrameRenderer::submit_to(Destination to, std::span<const stage::Camera> cameras, const FrameSettings& given,
                              const Then& then) {
    check_settings(cameras, given);
    if (device_.used_debug_buffer()) finish();  // the host reads and empties it when an image is finished
    queue_.turn();
    if (!finish(queue_.slot())) {
        finish();
        enlarge();
    }
    const TraceSpan span("record a frame");
    const FrameSettings settings = begin_with_memory_left(cameras, given);
    if (intervals_) intervals_->begin_frame(queue_.slot());
    commands().begin();
    record_frame(settings);
    if (to == Destination::kHost) record_readback();
    if (then) then(commands(), image_);
    queue_.submit();
}

void FrameRenderer::wait_for_device() {
    picks_.finish();
    queue_.wait_for_device();
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
    return image_;
}

std::vector<media::Image> FrameRenderer::render_views(std::span<const stage::Camera> cameras,
                                                      const FrameSettings& settings) {
    draw_to(Destination::kHost, cameras, settings, {});
    std::vector<media::Image> images;
    const uint8_t* from = readback_.as<uint8_t>();
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

}  // namespace neuvv::render
