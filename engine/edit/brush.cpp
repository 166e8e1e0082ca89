#include "edit/brush.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace neuvv {

namespace {

float distance_to_segment(glm::vec3 at, glm::vec3 a, glm::vec3 b) {
    const glm::vec3 along = b - a;
    const float length2 = glm::dot(along, along);
    const float part = length2 > 0 ? std::clamp(glm::dot(at - a, along) / length2, 0.0f, 1.0f) : 0.0f;
    return glm::distance(at, a + part * along);
}

// How near a place is to the stroke; infinite beyond the reach.
float distance_to_stroke(glm::vec3 at, std::span<const glm::vec3> points, float radius) {
    float nearest = std::numeric_limits<float>::infinity();
    for (size_t i = 0; i < points.size(); i++) {
        const bool joined = i > 0 && glm::distance(points[i - 1], points[i]) <= 2 * radius;
        nearest = std::min(nearest, distance_to_segment(at, joined ? points[i - 1] : points[i], points[i]));
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

std::vector<glm::vec3> points_under(Picker& picker, const Camera& camera, std::span<const glm::dvec2> pixels) {
    std::vector<PickRay> rays;
    for (size_t i = 0; i < pixels.size(); i++) {
        const glm::dvec2 from = pixels[i == 0 ? 0 : i - 1];
        // A ray a pixel; farther than a picture reaches there is nothing to pick.
        const double length = std::min(std::ceil(glm::distance(from, pixels[i])), 4.0 * (camera.width + camera.height));
        const auto steps = static_cast<size_t>(std::max(length, 1.0));
        for (size_t step = 1; step <= steps; step++)
            rays.push_back(
                pick_ray(camera, glm::mix(from, pixels[i], static_cast<double>(step) / static_cast<double>(steps))));
    }
    std::vector<glm::vec3> points;
    const std::vector<Picked> picked = picker.pick(rays);
    for (size_t i = 0; i < rays.size(); i++)
        if (picked[i].hit())
            points.push_back(glm::vec3(rays[i].origin) + picked[i].distance_m * glm::vec3(rays[i].direction));
    return points;
}

std::vector<LeafEdit> stroke(const Canvas& canvas, std::span<const float> sigma, const Brush& brush,
                             std::span<const glm::vec3> points) {
    if (points.empty()) return {};
    glm::vec3 low = points[0], high = points[0];
    for (const glm::vec3& point : points) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    const Region around = box_region(low - brush.radius_m, high + brush.radius_m);
    std::vector<float> covered(sigma.size());
    parallel_for(sigma.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; leaf++)
            if (sigma[leaf] > 0 && around(canvas.middles[leaf]))
                covered[leaf] = coverage(brush, distance_to_stroke(canvas.middles[leaf], points, brush.radius_m));
    });
    std::vector<LeafEdit> edits;
    for (uint32_t leaf = 0; leaf < covered.size(); leaf++) {
        const float alpha = brush.alpha * covered[leaf];
        const float density = covered[leaf] >= 0.5f ? brush.sigma : kKeepSigma;
        if (alpha > 0 || density >= 0) edits.push_back({leaf, 0, 0, brush.colour, alpha, density});
    }
    return edits;
}

std::vector<LeafEdit> fill_leaves(std::span<const uint32_t> leaves, glm::vec3 colour, float alpha) {
    std::vector<LeafEdit> edits;
    for (const uint32_t leaf : leaves) edits.push_back({leaf, 0, 0, colour, alpha});
    return edits;
}

std::vector<LeafEdit> set_density(std::span<const uint32_t> leaves, float sigma) {
    std::vector<LeafEdit> edits;
    for (const uint32_t leaf : leaves) edits.push_back({leaf, 0, 0, glm::vec3(0), 0, sigma});
    return edits;
}

glm::vec3 shifted(glm::vec3 colour, const ColourShift& shift) {
    // The hue turns around the grey axis: a rotation of the three channels (Rodrigues).
    const float angle = glm::radians(shift.hue_degrees), c = std::cos(angle), s = std::sin(angle);
    const glm::vec3 axis(1 / std::sqrt(3.0f));
    const glm::vec3 turned = colour * c + glm::cross(axis, colour) * s + axis * glm::dot(axis, colour) * (1 - c);
    const float grey = luminance(colour);
    // Turning changed the luminance; take its chroma alone, about the old one.
    const glm::vec3 chroma = shift.saturation * (turned - luminance(turned));
    float room = 1;  // so much of it stays within 0 to 1
    for (int i = 0; i < 3; i++) {
        if (grey + chroma[i] > 1) room = std::min(room, (1 - grey) / chroma[i]);
        if (grey + chroma[i] < 0) room = std::min(room, grey / -chroma[i]);
    }
    return glm::clamp(grey + room * chroma, 0.0f, 1.0f);
}

std::vector<LeafEdit> shift_colours(const VOctree& tree, std::span<const uint32_t> leaves, float frame,
                                    const ColourShift& shift) {
    std::vector<LeafEdit> edits;
    for (const uint32_t leaf : leaves) edits.push_back({leaf, 0, 0, shifted(mean_colour(tree, leaf, frame), shift), 1});
    return edits;
}

}  // namespace neuvv
