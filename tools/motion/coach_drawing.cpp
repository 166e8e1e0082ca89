#include "tools/motion/coach_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coach/guide.h"
#include "motion/video/triangulate.h"
#include "tools/image_drawing.h"

namespace neuvv::tools {

namespace {

Colour image_colour(const glm::vec3& colour) {
    const auto byte = [](float value) { return static_cast<uint8_t>(std::lround(255 * value)); };
    return {byte(colour.r), byte(colour.g), byte(colour.b)};
}

}  // namespace

void draw_guide(media::Image& image, const stage::Camera& camera, const glm::dmat4& world_from_performer,
                const coach::Coach& coach) {
    const int width = std::max(2, static_cast<int>(image.height / 240));
    for (const coach::GuideLine& line : coach::guide_of(coach)) {
        const auto pixel = [&](const glm::dvec3& point) {
            return motion::project(camera, glm::dvec3(world_from_performer * glm::dvec4(point, 1)));
        };
        const auto from = pixel(line.from), to = pixel(line.to);
        const Colour colour = image_colour(coach::kGuideColours[static_cast<size_t>(line.kind)]);
        if (from && to) draw_line(image, *from, *to, colour, width);
    }
}

void draw_remarks(media::Image& image, const coach::Coach& coach) {
    constexpr Colour kWhite = {255, 255, 255}, kShade = {0, 0, 0};
    const int height = std::max(12, static_cast<int>(image.height / 22)), edge = height * 2 / 3;
    int y = edge;
    const auto line = [&](const std::string& text, const Colour& colour) {
        const int shade = std::max(1, height / 16);  // letters stand on what the clip shows there
        draw_text(image, edge + shade, y + shade, text, kShade, height);
        draw_text(image, edge, y, text, colour, height);
        y += height * 5 / 4;
    };
    if (coach.feedback().score >= 0) line(fmt::format("score {:.0f}", coach.feedback().score), kWhite);
    for (const std::string& text : coach.remarks()) line(text, {255, 90, 70});
}

}  // namespace neuvv::tools
