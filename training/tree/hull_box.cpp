#include "training/tree/hull_box.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "base/trace_file.h"
#include "training/tree/silhouettes.h"

namespace neuvv::training {

namespace {

using Box = std::pair<glm::dvec3, glm::dvec3>;

// How far from a point an image reaches, in metres, where it crosses the point's depth: along its rows or columns,
// whichever reaches further.
double reach_from(const stage::Camera& camera, const glm::dvec3& point) {
    const glm::dvec4 p = glm::inverse(camera.world_from_camera) * glm::dvec4(point, 1);
    const double depth = std::abs(p.z), right = p.x * camera.fx / depth, down = -p.y * camera.fy / depth;  // pixels
    return depth * std::max(std::max(camera.cx + right, camera.width - camera.cx - right) / camera.fx,
                            std::max(camera.cy + down, camera.height - camera.cy - down) / camera.fy);
}

// What a data set without a box needs where its cameras do not say where the scene is, in the files of its layout.
const char* box_fix(const std::string& format) {
    if (format == "nerf" || format.empty()) return "add \"aabb\": [[x,y,z],[x,y,z]] in metres to the transforms file";
    if (format == "colmap") return "put points3D.bin or .txt of at least 100 points beside images.bin";
    return "add a camera that looks from another side";
}

// Where the cameras look: a cube around the point nearest to all optical axes, which holds what any image shows there.
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
                         "all cameras look the same way, so the scene's position is unknown", box_fix(dataset.format));
    const glm::dvec3 centre = glm::inverse(normal) * right;
    double half = 0;
    for (const stage::Camera& camera : dataset.cameras) half = std::max(half, reach_from(camera, centre));
    return {centre - half, centre + half};
}

// The cells of a grid of kBoxGrid³ that may hold matter at one time, as parts of touching cells.
struct Parts {
    std::vector<std::vector<uint32_t>> cells;  // by part: indices of cells
    std::vector<bool> sure;                    // by part: whether a third of the cameras see one of its cells
};

// The cells that touch a cell by a face, an edge or a corner, itself included.
template <typename Visit>
void for_each_neighbour(uint32_t cell, const Visit& visit) {
    constexpr uint32_t side = kBoxGrid;
    const uint32_t x = cell % side, y = cell / side % side, z = cell / side / side;
    for (uint32_t k = z - std::min(z, 1u); k <= std::min(z + 1, side - 1); ++k)
        for (uint32_t j = y - std::min(y, 1u); j <= std::min(y + 1, side - 1); ++j)
            for (uint32_t i = x - std::min(x, 1u); i <= std::min(x + 1, side - 1); ++i)
                visit((k * side + j) * side + i);
}

Parts find_parts(std::vector<uint16_t> witnesses, size_t least, size_t enough) {
    Parts parts;
    for (uint32_t seed = 0; seed < witnesses.size(); ++seed) {
        if (witnesses[seed] < least) continue;
        std::vector<uint32_t> part = {seed};
        size_t most = std::exchange(witnesses[seed], uint16_t{0});
        for (size_t i = 0; i < part.size(); ++i)
            for_each_neighbour(part[i], [&](uint32_t neighbour) {
                if (witnesses[neighbour] < least) return;
                most = std::max<size_t>(most, std::exchange(witnesses[neighbour], uint16_t{0}));
                part.push_back(neighbour);
            });
        parts.cells.push_back(std::move(part));
        parts.sure.push_back(most >= enough);
    }
    return parts;
}

// By image the foreground pixels that no sure part may explain.
std::vector<PixelSums> find_unexplained(const Dataset& dataset, const std::vector<Silhouette>& silhouettes,
                                        const std::vector<HullCell>& cells, const Parts& parts) {
    std::vector<HullCell> sure;
    for (size_t p = 0; p < parts.cells.size(); ++p)
        if (parts.sure[p])
            for (const uint32_t cell : parts.cells[p]) sure.push_back(cells[cell]);
    return unexplained_pixels(dataset, silhouettes, sure);
}

// Whether an image that shows all of a cell has a pixel there that is not explained without it.
bool is_needed(const std::vector<Silhouette>& silhouettes, const std::vector<PixelSums>& unexplained,
               const HullCell& cell) {
    for (size_t i = 0; i < silhouettes.size(); ++i) {
        const std::optional<PixelRectangle> image = image_of(silhouettes[i], cell);
        if (image && unexplained[i].count(*image) > 0) return true;
    }
    return false;
}

// Marks the cells that hold matter at a time. Where the images of most cameras end, two cameras are enough to leave a
// cell, and cells remain far from the performer that only happen to lie before or behind the foreground of those two.
// They form parts of their own that explain nothing: the performer is on their pixels' rays, too. These are left out.
void mark_matter(const Dataset& dataset, double time, const std::vector<HullCell>& cells, std::vector<bool>& matter) {
    const std::vector<Silhouette> silhouettes = silhouettes_at(dataset, time);
    const size_t third = (silhouettes.size() + 2) / 3;
    std::vector<uint16_t> witnesses(cells.size());
    parallel_for(cells.size(), 4096, [&](size_t begin, size_t end) {
        const std::span<const HullCell> part(&cells[begin], end - begin);
        const std::vector<Witnesses> found = count_witnesses(silhouettes, part);
        for (size_t i = begin; i < end; ++i) witnesses[i] = found[i - begin].whole;
    });
    const Parts parts = find_parts(std::move(witnesses), min_witnesses(silhouettes), third);
    const bool all_sure = std::all_of(parts.sure.begin(), parts.sure.end(), [](bool sure) { return sure; });
    const std::vector<PixelSums> unexplained =
        all_sure ? std::vector<PixelSums>() : find_unexplained(dataset, silhouettes, cells, parts);
    for (size_t p = 0; p < parts.cells.size(); ++p) {
        const std::vector<uint32_t>& part = parts.cells[p];
        if (parts.sure[p] || std::any_of(part.begin(), part.end(), [&](uint32_t cell) {
                return is_needed(silhouettes, unexplained, cells[cell]);
            }))
            for (const uint32_t cell : part) matter[cell] = true;
    }
}

// The box around the cells of a grid over a box that hold matter.
Box box_around(const Box& grid, const std::vector<HullCell>& cells, const std::vector<bool>& matter) {
    const glm::dvec3 half = 0.5 * (grid.second - grid.first) / static_cast<double>(kBoxGrid);
    Box box{grid.second, grid.first};
    for (size_t i = 0; i < cells.size(); ++i) {
        if (!matter[i]) continue;
        box.first = glm::min(box.first, glm::dvec3(cells[i].centre) - half);
        box.second = glm::max(box.second, glm::dvec3(cells[i].centre) + half);
    }
    return box;
}

}  // namespace

std::pair<glm::dvec3, glm::dvec3> first_box(const Dataset& dataset) {
    return dataset.box ? *dataset.box : box_from_cameras(dataset);
}

MatterGrid find_matter(const Dataset& dataset) {
    const TraceSpan span("find the matter");
    MatterGrid grid;
    grid.tight_box = first_box(dataset);
    for (int round = 0; round < 2; ++round) {
        grid.box = grid.tight_box;
        const std::vector<HullCell> cells = grid_cells(grid.box, kBoxGrid);
        grid.matter.assign(cells.size(), false);
        for (const double time : dataset.times) mark_matter(dataset, time, cells, grid.matter);
        if (std::find(grid.matter.begin(), grid.matter.end(), true) == grid.matter.end())
            throw InputError(dataset.folder.string(), "", "no point in space fits the mattes of the cameras",
                             "check that alpha is the matte, and that poses are camera-to-world with OpenGL axes");
        grid.tight_box = box_around(grid.box, cells, grid.matter);
    }
    return grid;
}

bool MatterGrid::overlaps(const Box& other) const {
    const glm::dvec3 size = (box.second - box.first) / static_cast<double>(kBoxGrid);
    const glm::ivec3 last(kBoxGrid - 1);
    const glm::dvec3 a = (other.first - box.first) / size, b = (other.second - box.first) / size;
    if (glm::any(glm::greaterThan(a, glm::dvec3(kBoxGrid))) || glm::any(glm::lessThan(b, glm::dvec3(0)))) return false;
    const glm::ivec3 low = glm::clamp(glm::ivec3(glm::floor(a)), glm::ivec3(0), last);
    const glm::ivec3 high = glm::clamp(glm::ivec3(glm::floor(b)), glm::ivec3(0), last);
    for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x)
                if (matter[static_cast<size_t>((z * int{kBoxGrid} + y) * int{kBoxGrid} + x)]) return true;
    return false;
}

Box hull_box(const Dataset& dataset) {
    return find_matter(dataset).tight_box;
}

}  // namespace neuvv::training
