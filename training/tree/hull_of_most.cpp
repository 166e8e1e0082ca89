#include "training/tree/hull_of_most.h"

#include <algorithm>
#include <cmath>

#include "base/threads/parallel.h"
#include "base/trace_file.h"

namespace neuvv::training {

namespace {

constexpr uint32_t kMinWitnesses = 3;
constexpr uint32_t kMostDivisions = 6;
constexpr size_t kMostCells = size_t{1} << 25;  // 512 MB; where mattes are white all over, cells stay larger
// Where so many cameras see a cell, one of them may be wrong.
constexpr uint32_t kMinForOneWrong = 8;
// Of a cell's ball, where the centre is judged or drawn: about a pixel, so that neighbours leave no gaps.
constexpr float kCentreShare = 0.2f, kDrawnShare = 0.45f;

bool is_kept(const std::vector<Silhouette>& silhouettes, const HullCell& cell, double dissent) {
    uint32_t see = 0, background = 0;
    for (const Silhouette& silhouette : silhouettes) {
        const Verdict verdict = judge(silhouette, cell);
        see += verdict != Verdict::kUnseen;
        background += verdict == Verdict::kBackground;
    }
    const uint32_t may_be_wrong = std::max<uint32_t>(see >= kMinForOneWrong, static_cast<uint32_t>(dissent * see));
    return see - background >= kMinWitnesses && background <= may_be_wrong;
}

void add_children(const HullCell& cell, std::vector<HullCell>& children) {
    const float quarter = cell.radius / (2 * std::sqrt(3.0f));  // of the cell's side
    for (int child = 0; child < 8; ++child) {
        const glm::vec3 side(child & 1 ? 1 : -1, child & 2 ? 1 : -1, child & 4 ? 1 : -1);
        children.push_back({cell.centre + quarter * side, cell.radius / 2});
    }
}

Silhouette silhouette_of(const CameraMask& camera) {
    Silhouette silhouette;
    silhouette.camera = camera.camera;
    silhouette.camera_from_world = glm::inverse(camera.camera->world_from_camera);
    silhouette.foreground = sums_of(camera.mask);
    if (camera.unseen) silhouette.ignored = sums_of(*camera.unseen);
    return silhouette;
}

}  // namespace

uint32_t divisions_for(const std::vector<stage::Camera>& cameras, const std::pair<glm::dvec3, glm::dvec3>& box,
                       double pixels) {
    const glm::dvec3 middle = (box.first + box.second) / 2.0, size = box.second - box.first;
    std::vector<double> metres;  // of a pixel there
    for (const stage::Camera& camera : cameras)
        metres.push_back(glm::distance(glm::dvec3(camera.world_from_camera[3]), middle) / camera.fx);
    std::ranges::sort(metres);
    const double cell = std::max({size.x, size.y, size.z}) / kFirstHullGrid;
    const double wanted = std::log2(cell / (pixels * metres[metres.size() / 2]));
    return static_cast<uint32_t>(std::clamp(std::round(wanted), 1.0, double{kMostDivisions}));
}

// Inner cells are divided, too: a hull of a person is thin.
std::vector<HullCell> cells_of_most(const std::vector<Silhouette>& silhouettes,
                                    const std::pair<glm::dvec3, glm::dvec3>& box, const HullSettings& settings) {
    std::vector<HullCell> cells = grid_cells(box, kFirstHullGrid);
    for (uint32_t division = 0;; ++division) {
        const bool last = division == settings.divisions;
        std::vector<uint8_t> kept(cells.size());
        parallel_for(cells.size(), 1024, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                HullCell judged = cells[i];
                if (last && settings.by_centres) judged.radius *= kCentreShare;
                kept[i] = is_kept(silhouettes, judged, settings.dissent);
            }
        });
        const auto count = static_cast<size_t>(std::ranges::count(kept, uint8_t{1}));
        const bool divides = !last && 8 * count <= kMostCells;
        std::vector<HullCell> next;
        for (size_t i = 0; i < cells.size(); ++i) {
            if (!kept[i]) continue;
            if (!divides)
                next.push_back(cells[i]);
            else
                add_children(cells[i], next);
        }
        cells = std::move(next);
        if (!divides) return cells;
    }
}

std::vector<PixelMask> hull_of_most(const std::vector<CameraMask>& cameras,
                                    const std::pair<glm::dvec3, glm::dvec3>& box, const HullSettings& settings) {
    const TraceSpan span("hull of most cameras");
    std::vector<Silhouette> silhouettes(cameras.size());
    parallel_for(cameras.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) silhouettes[i] = silhouette_of(cameras[i]);
    });
    std::vector<HullCell> cells = cells_of_most(silhouettes, box, settings);
    if (settings.by_centres)
        for (HullCell& cell : cells) cell.radius *= kDrawnShare;
    std::vector<PixelMask> seen(cameras.size());
    parallel_for(cameras.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const std::vector<bool> covered = covered_pixels(silhouettes[i], cells);
            seen[i] = PixelMask(cameras[i].mask.width, cameras[i].mask.height);
            std::copy(covered.begin(), covered.end(), seen[i].set.begin());
        }
    });
    return seen;
}

}  // namespace neuvv::training
