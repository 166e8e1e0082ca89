#include "training/mattes/working_size.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/threads/parallel.h"
#include "training/data/reduce.h"

namespace neuvv::training {

namespace {

// How much of the mask is around a position, in pixels whose centres are at +½; beyond the mask, its borders go on.
float share_at(const PixelMask& mask, glm::dvec2 position) {
    const auto clamped = [](double value, uint32_t size) { return std::clamp(value - 0.5, 0.0, size - 1.0); };
    const double x = clamped(position.x, mask.width), y = clamped(position.y, mask.height);
    const auto left = static_cast<uint32_t>(x), top = static_cast<uint32_t>(y);
    const uint32_t right = std::min(left + 1, mask.width - 1), bottom = std::min(top + 1, mask.height - 1);
    const auto at = [&](uint32_t u, uint32_t v) { return mask[size_t{v} * mask.width + u] ? 1.0 : 0.0; };
    const double u = x - left, v = y - top;
    return static_cast<float>((1 - v) * ((1 - u) * at(left, top) + u * at(right, top)) +
                              v * ((1 - u) * at(left, bottom) + u * at(right, bottom)));
}

}  // namespace

WorkingCamera working_camera(const RigCamera& camera, media::ImageSize size) {
    WorkingCamera working;
    working.lens = camera.lens;
    working.lens.width = size.width;
    working.lens.height = size.height;
    working.factor = (std::max({size.width, size.height, 1u}) + kWorkingSide - 1) / kWorkingSide;
    working.factor = std::clamp(working.factor, 1u, std::max(1u, std::min(size.width, size.height)));
    const uint32_t width = size.width / working.factor, height = size.height / working.factor;
    interchange::Lens whole = working.lens;  // of the part of the image that whole blocks cover
    whole.width = width * working.factor;
    whole.height = height * working.factor;
    const interchange::Lens small = interchange::scaled(whole, width, height);
    working.camera = {.world_from_camera = camera.world_from_camera,
                      .fx = small.fx,
                      .fy = small.fy,
                      .cx = small.cx,
                      .cy = small.cy,
                      .width = width,
                      .height = height};
    if (small.distorts()) working.undistortion = make_undistortion(small);
    return working;
}

media::Image working_image(const WorkingCamera& camera, const media::Image& image) {
    assert(image.width == camera.lens.width && image.height == camera.lens.height && "an image of this camera");
    media::Image opaque = image;
    for (size_t i = 3; i < opaque.rgba.size(); i += 4) opaque.rgba[i] = 255;
    if (camera.factor > 1) opaque = reduced(opaque, camera.factor);
    return camera.undistortion ? undistort(opaque, *camera.undistortion, ColourOf::kCapture) : opaque;
}

PixelMask unseen_pixels(const WorkingCamera& camera) {
    PixelMask unseen(camera.camera.width, camera.camera.height);
    if (camera.undistortion)
        for (size_t i = 0; i < unseen.size(); ++i) unseen.set[i] = !camera.undistortion->sees(i);
    return unseen;
}

PixelMask full_size(const WorkingCamera& camera, const PixelMask& mask) {
    if (camera.factor == 1 && !camera.undistortion) return mask;
    const interchange::Lens& lens = camera.lens;
    PixelMask full(lens.width, lens.height);
    parallel_for(lens.height, 16, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y)
            for (uint32_t x = 0; x < lens.width; ++x) {
                glm::dvec2 pixel(x + 0.5, static_cast<double>(y) + 0.5);
                if (camera.undistortion) {
                    const std::optional<glm::dvec2> direction = direction_at(lens, pixel);
                    if (!direction) continue;
                    pixel = {lens.cx + lens.fx * direction->x, lens.cy + lens.fy * direction->y};
                }
                full.set[y * lens.width + x] = share_at(mask, pixel / static_cast<double>(camera.factor)) >= 0.5f;
            }
    });
    return full;
}

}  // namespace neuvv::training
