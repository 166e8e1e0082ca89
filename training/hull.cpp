#include "training/hull.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace neuvv::training {

namespace {

constexpr uint8_t kMatteThreshold = 32;

// How many pixels of a kind lie above and to the left of each corner of pixels: the count in any rectangle takes four
// reads.
struct PixelSums {
    size_t stride = 0;
    std::vector<uint32_t> sums;  // (width+1) × (height+1); empty: no pixel is of the kind

    template <typename IsOfKind>
    PixelSums(uint32_t width, uint32_t height, const IsOfKind& is_of_kind) : stride(size_t{width} + 1) {
        sums.resize(stride * (size_t{height} + 1));
        for (uint32_t y = 0; y < height; y++) {
            uint32_t row = 0;
            for (uint32_t x = 0; x < width; x++) {
                row += is_of_kind(x, y) ? 1 : 0;
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
            }
        }
    }
    PixelSums() = default;

    uint32_t count(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) const {
        if (sums.empty()) return 0;
        return sums[y1 * stride + x1] - sums[y0 * stride + x1] - sums[y1 * stride + x0] + sums[y0 * stride + x0];
    }
};

struct Silhouette {
    glm::dmat4 camera_from_world{1};
    const stage::Camera* camera = nullptr;
    PixelSums foreground, ignored;
};

Silhouette make_silhouette(const Dataset& dataset, const View& view) {
    Silhouette silhouette;
    silhouette.camera = &dataset.cameras[view.camera];
    silhouette.camera_from_world = glm::inverse(silhouette.camera->world_from_camera);
    const uint32_t width = silhouette.camera->width, height = silhouette.camera->height;
    silhouette.foreground =
        PixelSums(width, height, [&](uint32_t x, uint32_t y) { return view.image.at(x, y)[3] >= kMatteThreshold; });
    if (!view.ignored.empty())
        silhouette.ignored = PixelSums(width, height, [&](uint32_t x, uint32_t y) { return view.ignores(x, y); });
    return silhouette;
}

// What an image shows of a cell; kUnseen: nothing can be said.
enum class Verdict { kUnseen, kBackground, kMatter };

Verdict judge(const Silhouette& silhouette, const HullCell& cell) {
    const stage::Camera& camera = *silhouette.camera;
    const glm::dvec4 p = silhouette.camera_from_world * glm::dvec4(glm::dvec3(cell.centre), 1);
    const double depth = -p.z, radius = static_cast<double>(cell.radius);
    if (depth <= 2 * radius) return Verdict::kUnseen;
    const double x = camera.cx + camera.fx * p.x / depth, y = camera.cy - camera.fy * p.y / depth;
    // The ball's image lies inside this rectangle, whose size is that at the distance of the ball's nearest point.
    // Matter in the ball is visible in pixels whose centres are at most half a pixel further out.
    const double half_width = camera.fx * radius * (1 + std::abs(p.x) / depth) / (depth - radius) + 0.5;
    const double half_height = camera.fy * radius * (1 + std::abs(p.y) / depth) / (depth - radius) + 0.5;
    const double left = std::ceil(x - half_width - 0.5), right = std::floor(x + half_width - 0.5) + 1;
    const double top = std::ceil(y - half_height - 0.5), bottom = std::floor(y + half_height - 0.5) + 1;
    if (!(left >= 0 && top >= 0 && right <= camera.width && bottom <= camera.height)) return Verdict::kUnseen;
    const auto x0 = static_cast<uint32_t>(left), x1 = static_cast<uint32_t>(right);
    const auto y0 = static_cast<uint32_t>(top), y1 = static_cast<uint32_t>(bottom);
    if (silhouette.foreground.count(x0, y0, x1, y1) > 0) return Verdict::kMatter;
    return silhouette.ignored.count(x0, y0, x1, y1) > 0 ? Verdict::kUnseen : Verdict::kBackground;
}

bool may_hold_matter(const std::vector<Silhouette>& silhouettes, const HullCell& cell) {
    size_t seen = 0;
    for (const Silhouette& silhouette : silhouettes) {
        const Verdict verdict = judge(silhouette, cell);
        if (verdict == Verdict::kBackground) return false;
        if (verdict == Verdict::kMatter) seen++;
    }
    return seen >= std::min<size_t>(2, silhouettes.size());
}

std::vector<Silhouette> silhouettes_at(const Dataset& dataset, double time) {
    std::vector<const View*> views;
    for (const View& view : dataset.views)
        if (view.time == time) views.push_back(&view);
    std::vector<Silhouette> silhouettes(views.size());
    parallel_for(views.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) silhouettes[i] = make_silhouette(dataset, *views[i]);
    });
    return silhouettes;
}

// Where the cameras look: a cube around the point nearest to all optical axes, as large as the widest image there.
std::pair<glm::dvec3, glm::dvec3> box_from_cameras(const Dataset& dataset) {
    glm::dmat3 normal(0);
    glm::dvec3 right(0);
    for (const stage::Camera& camera : dataset.cameras) {
        const glm::dvec3 axis = -glm::dvec3(camera.world_from_camera[2]), origin(camera.world_from_camera[3]);
        const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(axis, axis);
        normal += across;
        right += across * origin;
    }
    if (std::abs(glm::determinant(normal)) < 1e-9)
        throw InputError(dataset.folder.string(), "",
                         "all cameras look the same way, so the scene's position is unknown",
                         "add \"aabb\": [[x,y,z],[x,y,z]] in metres to the transforms file");
    const glm::dvec3 centre = glm::inverse(normal) * right;
    double half = 0;
    for (const stage::Camera& camera : dataset.cameras) {
        const double distance = glm::length(glm::dvec3(camera.world_from_camera[3]) - centre);
        half = std::max(half, 0.5 * distance * std::max(camera.width / camera.fx, camera.height / camera.fy));
    }
    return {centre - half, centre + half};
}

constexpr uint32_t kBoxGrid = 48;  // cells along each side of the grid with which the box is searched

std::vector<HullCell> grid_cells(const std::pair<glm::dvec3, glm::dvec3>& box) {
    const glm::dvec3 size = (box.second - box.first) / static_cast<double>(kBoxGrid);
    std::vector<HullCell> cells;
    for (uint32_t z = 0; z < kBoxGrid; z++)
        for (uint32_t y = 0; y < kBoxGrid; y++)
            for (uint32_t x = 0; x < kBoxGrid; x++)
                cells.push_back({glm::vec3(box.first + size * (glm::dvec3(x, y, z) + 0.5)),
                                 static_cast<float>(0.5 * glm::length(size))});
    return cells;
}

}  // namespace

std::vector<uint32_t> carve(const Dataset& dataset, const std::vector<HullCell>& cells) {
    const size_t words = hull_words(dataset);
    std::vector<uint32_t> bits(cells.size() * words);
    for (size_t t = 0; t < dataset.times.size(); t++) {
        const std::vector<Silhouette> silhouettes = silhouettes_at(dataset, dataset.times[t]);
        parallel_for(cells.size(), 4096, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; i++)
                if (may_hold_matter(silhouettes, cells[i])) bits[i * words + t / 32] |= 1u << t % 32;
        });
    }
    return bits;
}

std::pair<glm::dvec3, glm::dvec3> hull_box(const Dataset& dataset) {
    std::pair<glm::dvec3, glm::dvec3> box = dataset.box ? *dataset.box : box_from_cameras(dataset);
    const size_t words = hull_words(dataset);
    for (int round = 0; round < 2; round++) {
        const std::vector<HullCell> cells = grid_cells(box);
        const std::vector<uint32_t> bits = carve(dataset, cells);
        const glm::dvec3 half = 0.5 * (box.second - box.first) / static_cast<double>(kBoxGrid);
        glm::dvec3 low = box.second, high = box.first;
        for (size_t i = 0; i < cells.size(); i++) {
            const auto first = bits.begin() + static_cast<ptrdiff_t>(i * words);
            if (std::none_of(first, first + static_cast<ptrdiff_t>(words), [](uint32_t word) { return word != 0; }))
                continue;
            low = glm::min(low, glm::dvec3(cells[i].centre) - half);
            high = glm::max(high, glm::dvec3(cells[i].centre) + half);
        }
        if (low.x >= high.x)
            throw InputError(dataset.folder.string(), "", "no point in space fits the mattes of the cameras",
                             "check that alpha is the matte, and that poses are camera-to-world with OpenGL axes");
        box = {low, high};
    }
    return box;
}

}  // namespace neuvv::training
