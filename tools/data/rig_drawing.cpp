#include "tools/data/rig_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/image_drawing.h"

namespace neuvv::tools {

namespace {

constexpr uint32_t kPanel = 640;   // pixels a side
constexpr double kRigMargin = 60;  // pixels around the rig, for names
constexpr size_t kLongestName = 14;
constexpr Colour kWhite = {255, 255, 255}, kBlack = {0, 0, 0}, kGrey = {150, 150, 150}, kTrain = {30, 90, 200},
                 kTest = {230, 110, 0};

media::Image blank(uint32_t width, uint32_t height, const Colour& colour) {
    media::Image image(width, height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            set_pixel(image, x, y, colour);
            image.at(x, y)[3] = 255;
        }
    return image;
}

// A projection of the world along one of its axes onto a square of the image.
struct Panel {
    double left = 0;  // pixels
    glm::dvec3 right{1, 0, 0}, down{0, 0, 1}, centre{0};
    double pixels_per_unit = 1;

    glm::dvec2 operator()(glm::dvec3 world) const {
        const glm::dvec3 p = world - centre;
        return {left + 0.5 * kPanel + pixels_per_unit * glm::dot(p, right),
                0.5 * kPanel + pixels_per_unit * glm::dot(p, down)};
    }
};

glm::dvec3 position_of(const training::RigCamera& camera) {
    return glm::dvec3(camera.world_from_camera[3]);
}

// The corners of the camera's image at this depth, in the world.
std::array<glm::dvec3, 4> corners(const training::RigCamera& camera, double depth) {
    const interchange::Lens& lens = camera.lens;
    const double width = lens.width ? lens.width : 2 * lens.cx, height = lens.height ? lens.height : 2 * lens.cy;
    std::array<glm::dvec3, 4> result{};
    for (int i = 0; i < 4; ++i) {
        const double u = i == 1 || i == 2 ? width : 0, v = i >= 2 ? height : 0;
        const glm::dvec3 at((u - lens.cx) / lens.fx, -(v - lens.cy) / lens.fy, -1);
        result[static_cast<size_t>(i)] = glm::dvec3(camera.world_from_camera * glm::dvec4(depth * at, 1));
    }
    return result;
}

void draw_camera(media::Image& image, const Panel& panel, const training::RigCamera& camera, double depth,
                 const Colour& colour) {
    const glm::dvec2 apex = panel(position_of(camera));
    const auto ends = corners(camera, depth);
    for (size_t i = 0; i < 4; ++i) {
        draw_line(image, apex, panel(ends[i]), colour);
        draw_line(image, panel(ends[i]), panel(ends[(i + 1) % 4]), colour);
    }
    // The name stands behind the camera, where no frustum is.
    const std::string name = camera.name.substr(camera.name.size() - std::min(camera.name.size(), kLongestName));
    const glm::dvec2 length(text_width(name), kTextHeight);
    const glm::dvec2 back = apex - panel(position_of(camera) - glm::dvec3(camera.world_from_camera[2]));
    const double distance = glm::length(back);
    const glm::dvec2 away = distance > 1e-6 ? back / distance : glm::dvec2(0, -1);
    const glm::dvec2 corner = apex + away * (0.5 * length + 4.0) - 0.5 * length;
    draw_text(image, static_cast<int>(corner.x), static_cast<int>(corner.y), name, colour);
}

void draw_box(media::Image& image, const Panel& panel, const std::pair<glm::dvec3, glm::dvec3>& box) {
    const auto corner = [&](int i) {
        return panel({i & 1 ? box.second.x : box.first.x, i & 2 ? box.second.y : box.first.y,
                      i & 4 ? box.second.z : box.first.z});
    };
    for (int i = 0; i < 8; ++i)
        for (const int axis : {1, 2, 4})
            if (!(i & axis)) draw_line(image, corner(i), corner(i | axis), kBlack);
}

void draw_scale(media::Image& image, const Panel& panel, const char* title) {
    const double unit = std::pow(10, std::floor(std::log10(0.4 * kPanel / panel.pixels_per_unit)));
    const glm::dvec2 start(panel.left + 10, kPanel - 12.0);
    const glm::dvec2 end = start + glm::dvec2(unit * panel.pixels_per_unit, 0);
    draw_line(image, start, end, kBlack);
    for (const glm::dvec2 tick : {start, end})
        draw_line(image, tick - glm::dvec2(0, 3), tick + glm::dvec2(0, 3), kBlack);
    draw_text(image, static_cast<int>(start.x), static_cast<int>(start.y) - 16, fmt::format("{:g}", unit), kBlack);
    draw_text(image, static_cast<int>(panel.left) + 10, 8, title, kBlack);
}

// Of all cameras and the box.
std::pair<glm::dvec3, glm::dvec3> bounds(const std::vector<const training::RigCamera*>& cameras,
                                         const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box) {
    std::pair<glm::dvec3, glm::dvec3> result{glm::dvec3(1e30), glm::dvec3(-1e30)};
    const auto include = [&](glm::dvec3 point) {
        result = {glm::min(result.first, point), glm::max(result.second, point)};
    };
    for (const training::RigCamera* camera : cameras) include(position_of(*camera));
    if (box) include(box->first), include(box->second);
    return result;
}

}  // namespace

media::Image draw_rig(const std::vector<training::RigCamera>& train, const std::vector<training::RigCamera>& test,
                      const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box) {
    media::Image image = blank(2 * kPanel, kPanel, kWhite);
    std::vector<const training::RigCamera*> all;
    for (const training::RigCamera& camera : train) all.push_back(&camera);
    for (const training::RigCamera& camera : test) all.push_back(&camera);
    const auto [low, high] = bounds(all, box);
    const glm::dvec3 size = high - low;
    const double longest = std::max({size.x, size.y, size.z, 1e-6});
    const double depth = 0.08 * longest;
    Panel above;
    above.centre = 0.5 * (low + high);
    above.pixels_per_unit = (kPanel - 2 * kRigMargin) / (longest + depth);
    Panel side = above;
    side.left = kPanel;
    side.down = {0, -1, 0};
    for (const Panel& panel : {above, side}) {
        if (box) draw_box(image, panel, *box);
        for (size_t i = 0; i < all.size(); ++i)
            draw_camera(image, panel, *all[i], depth, i < train.size() ? kTrain : kTest);
    }
    draw_line(image, {kPanel, 0}, {kPanel, kPanel}, kGrey);
    draw_scale(image, above, "from above: x right, z down");
    draw_scale(image, side, "from the side: x right, y up");
    return image;
}

}  // namespace neuvv::tools
