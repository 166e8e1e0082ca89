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

// Replaces the colour of an eye's wide view where the narrow one shows the ray.
void see_narrow(Colour& colour, const LinearImage& image, const XrFovf& fov, XrVector3f ray) {
    const float left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
    const float up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);
    const float u = (ray.x - left) / (right - left), v = (ray.y - up) / (down - up);
    if (u < 0 || u >= 1 || v < 0 || v >= 1) return;
    colour = sampled(image, u * static_cast<float>(image.width), v * static_cast<float>(image.height));
}

// The user's room along a ray of an eye: grey walls, and a floor of tiles of half a metre, at the height of STAGE.
Colour room(const XrPosef& head, XrVector3f ray) {
    const XrVector3f along = rotate(head.orientation, ray);
    if (along.y >= -1e-3f) return {{0.3f, 0.3f, 0.35f, 1}};
    const XrVector3f at = head.position + along * (-head.position.y / along.y);
    const auto tile = static_cast<int64_t>(std::floor(2 * at.x) + std::floor(2 * at.z));
    const float grey = tile % 2 == 0 ? 0.5f : 0.4f;
    return {{grey, grey, grey, 1}};
}

}  // namespace

LinearImage compose(const std::vector<Layer>& layers, const std::vector<LinearImage>& images,
                    const std::vector<LinearImage>& narrow, uint32_t eye, XrTime time, XrEnvironmentBlendMode mode) {
    const Script& script = runtime().script;
    LinearImage seen = {script.width, script.height, std::vector<float>(size_t{script.width} * script.height * 4)};
    const XrFovf& fov = script.fov[eye];
    const float left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
    const float up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);
    const XrPosef head = head_in_world(time).pose;
    // Calls `change` with each pixel, its position in the image, 0..1, and its ray.
    const auto for_each = [&](const auto& change) {
        for (uint32_t y = 0; y < seen.height; ++y)
            for (uint32_t x = 0; x < seen.width; ++x) {
                const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(seen.width);
                const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(seen.height);
                change(seen.at(x, y), u, v, XrVector3f{left + (right - left) * u, up + (down - up) * v, -1});
            }
    };

    const bool begins_with_room = mode == XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND;
    for_each([&](float* pixel, float, float, XrVector3f ray) {
        const Colour first = begins_with_room ? room(head, ray) : Colour{{0, 0, 0, 1}};
        std::copy_n(first.rgba, 4, pixel);
    });
    for (size_t i = 0; i < layers.size(); ++i) {
        const Layer& layer = layers[i];
        if (layer.is_quad() && !is_for(layer, eye)) continue;
        const LinearImage& image = images[i];
        const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
        const XrPosef eye_in_quad =
            layer.is_quad() ? inverse(layer.pose) * view_in(*layer.space, eye, time).pose : kIdentityPose;
        for_each([&](float* pixel, float u, float v, XrVector3f ray) {
            if (layer.kind == LayerKind::kPassthrough) return blend(pixel, room(head, ray), layer.flags);
            const Hit hit =
                layer.is_quad() ? hit_quad(layer, image, eye_in_quad, ray) : Hit{true, u * width, v * height};
            if (!hit.is_hit) return;
            Colour colour = sampled(image, hit.x, hit.y);
            if (layer.views.size() > 2) see_narrow(colour, narrow[i], layer.fov[2 + eye], ray);
            blend(pixel, colour, layer.flags);
        });
    }
    if (mode == XR_ENVIRONMENT_BLEND_MODE_ADDITIVE)
        for_each([&](float* pixel, float, float, XrVector3f ray) {
            const Colour added = room(head, ray);
            for (int c = 0; c < 3; ++c) pixel[c] += added.rgba[c];
        });
    return seen;
}

}  // namespace neuvv::xr_runtime
