// A simple compositor, so that a person can look at what the headset would show.
#include <algorithm>
#include <cmath>

#include "images.h"
#include "pose.h"
#include "spaces.h"

namespace neuvv::xr_runtime {

namespace {

struct Colour {
    float rgba[4];
};

// Bilinear interpolation between texel centres, clamped to the edge; x and y are in texels.
Colour sampled(const LinearImage& image, float x, float y) {
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float s = x - 0.5f - left, t = y - 0.5f - top;
    auto texel = [&](float column, float row) {
        const float last_x = static_cast<float>(image.width - 1), last_y = static_cast<float>(image.height - 1);
        return image.at(static_cast<uint32_t>(std::clamp(column, 0.0f, last_x)),
                        static_cast<uint32_t>(std::clamp(row, 0.0f, last_y)));
    };
    const float *a = texel(left, top), *b = texel(left + 1, top), *c = texel(left, top + 1),
                *d = texel(left + 1, top + 1);
    Colour colour;
    for (int i = 0; i < 4; ++i)
        colour.rgba[i] = (a[i] * (1 - s) + b[i] * s) * (1 - t) + (c[i] * (1 - s) + d[i] * s) * t;
    return colour;
}

void blend(float* under, const Colour& over, XrCompositionLayerFlags flags) {
    const bool has_alpha = flags & XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT;
    const bool is_straight = flags & XR_COMPOSITION_LAYER_UNPREMULTIPLIED_ALPHA_BIT;
    const float alpha = has_alpha ? over.rgba[3] : 1;
    const float scale = has_alpha && is_straight ? alpha : 1;
    for (int i = 0; i < 3; ++i) under[i] = over.rgba[i] * scale + under[i] * (1 - alpha);
}

bool is_for(const Layer& layer, uint32_t eye) {
    const XrEyeVisibility own = eye == 0 ? XR_EYE_VISIBILITY_LEFT : XR_EYE_VISIBILITY_RIGHT;
    return layer.eyes == XR_EYE_VISIBILITY_BOTH || layer.eyes == own;
}

// Where a ray from the eye hits the front of a quad, in texels of the quad's image.
struct Hit {
    bool is_hit;
    float x, y;
};
Hit hit_quad(const Layer& layer, const LinearImage& image, const XrPosef& eye_in_quad, XrVector3f direction) {
    const XrVector3f ray = rotate(eye_in_quad.orientation, direction), from = eye_in_quad.position;
    if (from.z <= 0 || ray.z >= 0) return {false, 0, 0};  // a quad is visible from its +Z side only
    const float t = -from.z / ray.z;
    const float u = (from.x + ray.x * t) / layer.size.width + 0.5f;
    const float v = 0.5f - (from.y + ray.y * t) / layer.size.height;
    const bool is_inside = u >= 0 && u < 1 && v >= 0 && v < 1;
    return {is_inside, u * static_cast<float>(image.width), v * static_cast<float>(image.height)};
}

}  // namespace

LinearImage compose(const std::vector<Layer>& layers, const std::vector<LinearImage>& images, uint32_t eye,
                    XrTime time) {
    const Script& script = runtime().script;
    LinearImage seen = {script.width, script.height, std::vector<float>(size_t{script.width} * script.height * 4)};
    for (size_t i = 3; i < seen.rgba.size(); i += 4) seen.rgba[i] = 1;
    const XrFovf& fov = script.fov[eye];
    const float left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
    const float up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);

    for (size_t i = 0; i < layers.size(); ++i) {
        const Layer& layer = layers[i];
        if (layer.is_quad && !is_for(layer, eye)) continue;
        const LinearImage& image = images[i];
        const XrPosef eye_in_quad = inverse(layer.pose) * view_in(*layer.space, eye, time).pose;
        for (uint32_t y = 0; y < seen.height; ++y)
            for (uint32_t x = 0; x < seen.width; ++x) {
                const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(seen.width);
                const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(seen.height);
                Hit hit = {true, u * static_cast<float>(image.width), v * static_cast<float>(image.height)};
                if (layer.is_quad)
                    hit = hit_quad(layer, image, eye_in_quad, {left + (right - left) * u, up + (down - up) * v, -1});
                if (hit.is_hit) blend(seen.at(x, y), sampled(image, hit.x, hit.y), layer.flags);
            }
    }
    return seen;
}

}  // namespace neuvv::xr_runtime
