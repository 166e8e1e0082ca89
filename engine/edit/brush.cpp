#include "edit/brush.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/threads/parallel.h"

namespace neuvv::edit {

namespace {

// The alphas that a ray has gathered at the front and the back of a touch; a ray that never gathers the middle one
// makes no touch.
constexpr float kTouchFront = 0.02f, kTouchMiddle = 0.5f, kTouchBack = 0.9f;
// The colours of a leaf over a clip count as the same while no channel differs by more. The measure is the square root
// of a channel, which is about how bright it looks.
constexpr float kSameColour = 0.06f;

float distance_to_segment(glm::vec3 at, glm::vec3 a, glm::vec3 b) {
    const glm::vec3 along = b - a;
    const float length2 = glm::dot(along, along);
    const float part = length2 > 0 ? std::clamp(glm::dot(at - a, along) / length2, 0.0f, 1.0f) : 0.0f;
    return glm::distance(at, a + part * along);
}

// The distance from a point to the stroke, metres; larger than the radius where the stroke does not cover it.
float distance_to_stroke(glm::vec3 at, std::span<const Touch> touches, float radius) {
    float nearest = std::numeric_limits<float>::infinity();
    for (size_t i = 0; i < touches.size(); ++i) {
        nearest = std::min(nearest, distance_to_segment(at, touches[i].front, touches[i].back));
        if (i == 0) continue;
        for (const auto& [from, to] :
             {std::pair(touches[i - 1].front, touches[i].front), std::pair(touches[i - 1].back, touches[i].back)})
            if (glm::distance(from, to) <= 2 * radius) nearest = std::min(nearest, distance_to_segment(at, from, to));
    }
    return nearest;
}

float coverage(const Brush& brush, float distance_m) {
    const float at = distance_m / brush.radius_m;
    if (at >= 1) return 0;
    if (at <= brush.hardness) return 1;
    const float rest = (1 - at) / (1 - brush.hardness);
    return rest * rest * (3 - 2 * rest);
}

float luminance(glm::vec3 c) {
    return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

}  // namespace

std::vector<Touch> touches_under(render::Picker& picker, const stage::Camera& camera,
                                 std::span<const glm::dvec2> pixels) {
    std::vector<PickRay> rays;
    for (size_t i = 0; i < pixels.size(); ++i) {
        const glm::dvec2 from = pixels[i == 0 ? 0 : i - 1];
        // One ray per pixel. The number of rays is limited, because lines that are much longer than the image have
        // nothing to pick.
        const double length = std::min(std::ceil(glm::distance(from, pixels[i])), 4.0 * (camera.width + camera.height));
        const auto steps = static_cast<size_t>(std::max(length, 1.0));
        for (size_t step = 1; step <= steps; ++step)
            rays.push_back(render::pick_ray(
                camera, glm::mix(from, pixels[i], static_cast<double>(step) / static_cast<double>(steps))));
    }
    const std::vector<render::Picked> fronts = picker.pick(rays, kTouchFront),
                                      middles = picker.pick(rays, kTouchMiddle);
    const std::vector<render::Picked> far = picker.pick(rays, kTouchBack), farther = picker.pick(rays);
    std::vector<Touch> touches;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!middles[i].hit()) continue;
        const auto point_at = [&](const render::Picked& picked) {
            return glm::vec3(rays[i].origin) + picked.distance_m * glm::vec3(rays[i].direction);
        };
        const render::Picked& back = farther[i].hit() ? farther[i] : far[i].hit() ? far[i] : middles[i];
        touches.push_back({point_at(fronts[i]), point_at(back)});
    }
    return touches;
}

std::vector<voctree::LeafEdit> stroke(const Canvas& canvas, std::span<const float> sigma, const Brush& brush,
                                      std::span<const Touch> touches) {
    if (touches.empty()) return {};
    glm::vec3 low = touches[0].front, high = touches[0].front;
    for (const Touch& touch : touches) {
        low = glm::min(low, glm::min(touch.front, touch.back));
        high = glm::max(high, glm::max(touch.front, touch.back));
    }
    const Region bounds = box_region(low - brush.radius_m, high + brush.radius_m);
    std::vector<float> covered(sigma.size());
    parallel_for(sigma.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf)
            if (sigma[leaf] > 0 && bounds(canvas.centres[leaf]))
                covered[leaf] = coverage(brush, distance_to_stroke(canvas.centres[leaf], touches, brush.radius_m));
    });
    std::vector<voctree::LeafEdit> edits;
    for (uint32_t leaf = 0; leaf < covered.size(); ++leaf) {
        const float alpha = brush.alpha * covered[leaf];
        const float density = covered[leaf] >= 0.5f ? brush.sigma : voctree::kKeepSigma;
        if (alpha > 0 || density >= 0) edits.push_back({leaf, 0, 0, brush.colour, alpha, density});
    }
    return edits;
}

std::vector<voctree::LeafEdit> fill_leaves(std::span<const uint32_t> leaves, glm::vec3 colour, float alpha) {
    std::vector<voctree::LeafEdit> edits;
    for (const uint32_t leaf : leaves) edits.push_back({leaf, 0, 0, colour, alpha});
    return edits;
}

std::vector<voctree::LeafEdit> set_density(std::span<const uint32_t> leaves, float sigma) {
    std::vector<voctree::LeafEdit> edits;
    for (const uint32_t leaf : leaves) edits.push_back({leaf, 0, 0, glm::vec3(0), 0, sigma});
    return edits;
}

glm::vec3 shifted(glm::vec3 colour, const ColourShift& shift) {
    // The hue turns around the grey axis: a rotation of the three channels (Rodrigues).
    const float angle = glm::radians(shift.hue_degrees), c = std::cos(angle), s = std::sin(angle);
    const glm::vec3 axis(1 / std::sqrt(3.0f));
    const glm::vec3 turned = colour * c + glm::cross(axis, colour) * s + axis * glm::dot(axis, colour) * (1 - c);
    const float grey = luminance(colour);
    // Turning changed the luminance: only the chroma of the result is kept, about the old luminance.
    const glm::vec3 chroma = shift.saturation * (turned - luminance(turned));
    float room = 1;  // the largest share of the chroma with which all channels stay within 0 to 1
    for (int i = 0; i < 3; ++i) {
        if (grey + chroma[i] > 1) room = std::min(room, (1 - grey) / chroma[i]);
        if (grey + chroma[i] < 0) room = std::min(room, grey / -chroma[i]);
    }
    return glm::clamp(grey + room * chroma, 0.0f, 1.0f);
}

namespace {

// Successive frames at which a leaf has about the same shifted colour.
struct Shade {
    float first = 0, last = 0;
    glm::vec3 low{0}, high{0};  // the range of the colours' square roots
    glm::vec3 sum{0};           // of the colours, weighted by density
    float weight = 0;
};

// The shades of a leaf over the frames; `rows` belongs to `frames`.
std::vector<Shade> shades_of(const voctree::VOctree& tree, uint32_t leaf, std::span<const float> frames,
                             std::span<const voctree::RowsAtTime> rows, const ColourShift& shift) {
    std::vector<Shade> shades;
    bool there = false;
    for (size_t i = 0; i < frames.size(); ++i) {
        const float sigma = density(tree, rows[i], leaf);
        const bool before = std::exchange(there, sigma > 0);
        if (!there) continue;
        const glm::vec3 colour = shifted(mean_colour(tree, rows[i], leaf), shift), root = glm::sqrt(colour);
        if (before) {
            Shade& shade = shades.back();
            const glm::vec3 low = glm::min(shade.low, root), high = glm::max(shade.high, root);
            if (glm::all(glm::lessThanEqual(high - low, glm::vec3(kSameColour)))) {
                shade = {shade.first, frames[i], low, high, shade.sum + sigma * colour, shade.weight + sigma};
                continue;
            }
        }
        shades.push_back({frames[i], frames[i], root, root, sigma * colour, sigma});
    }
    return shades;
}

}  // namespace

std::vector<voctree::LeafEdit> shift_colours(const Canvas& canvas, std::span<const uint32_t> leaves, float first,
                                             float last, const ColourShift& shift) {
    std::vector<float> frames{first};
    for (float frame = std::floor(first) + 1; frame < last; ++frame) frames.push_back(frame);
    if (last > first) frames.push_back(last);
    std::vector<voctree::RowsAtTime> rows;
    for (const float frame : frames) rows.emplace_back(canvas.tree, double{frame});
    std::vector<std::vector<voctree::LeafEdit>> of_leaf(leaves.size());
    parallel_for(leaves.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            for (const Shade& shade : shades_of(canvas.tree, leaves[i], frames, rows, shift))
                of_leaf[i].push_back({leaves[i], shade.first, shade.last, shade.sum / shade.weight, 1});
    });
    std::vector<voctree::LeafEdit> edits;
    for (const std::vector<voctree::LeafEdit>& some : of_leaf) edits.insert(edits.end(), some.begin(), some.end());
    return extend_between_frames(std::move(edits), first, last);
}

}  // namespace neuvv::edit
