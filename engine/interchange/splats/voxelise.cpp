#include "interchange/splats/voxelise.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <span>

#include "base/error.h"
#include "base/platform.h"
#include "base/threads/parallel.h"
#include "interchange/volume/still_tree.h"
#include "media/image.h"
#include "voctree/sh_weights.h"

namespace neuvv::interchange {

namespace {

// Renderers let no splat hide more.
constexpr float kDensest = 0.99f;
// Renderers widen splats by 0.3 pixels², and those of a trained scene leave gaps without that. A cell is our pixel.
constexpr float kWideningOfCell = 0.3f;
// Cells have at most so many deviations of the splats in them, where the resolution allows it.
constexpr float kDeviationsOfCell = 0.5f;
constexpr float kDeviationsOfSample = 0.75f;
constexpr int kMostSamples = 8;  // along an axis: those of a splat that lies in the cell as a whole
constexpr uint32_t kTaskDepth = 3;
// Condon-Shortley: harmonics of odd m change their sign.
constexpr std::array<float, kMaxShCount> kSignOfHarmonic = {1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1};

// Li_½(z) = Σ zⁿ/√n for z from 0 to kDensest. Of a Gaussian alpha o·exp(−r²/2) at a distance r, the optical depth
// −ln(1 − alpha) is Σ oⁿ/n · exp(−n r²/2). Each term is the line integral of a Gaussian of variance 1/n, so that the
// density is Σ oⁿ/n · √(n/2π) · exp(−n r²/2) = Li_½(o·exp(−r²/2)) / √(2π).
class Polylogarithm {
  public:
    Polylogarithm() {
        for (int i = 0; i <= kSteps; ++i) {
            const double z = double{kDensest} * i / kSteps;
            double sum = 0, power = z;
            for (int n = 1; power > 1e-7; ++n, power *= z) sum += power / std::sqrt(n);
            values_.push_back(static_cast<float>(sum));
        }
    }
    float at(float z) const {
        const float x = std::clamp(z / kDensest, 0.0f, 1.0f) * kSteps;
        const size_t i = std::min(static_cast<size_t>(x), values_.size() - 2);
        return values_[i] + (x - static_cast<float>(i)) * (values_[i + 1] - values_[i]);
    }

  private:
    static constexpr int kSteps = 2048;
    std::vector<float> values_;
};

// A splat as cells need it.
struct Blob {
    const Splat* splat;
    glm::mat3 axes;         // its rows are the splat's axes
    glm::vec3 deviation_m;  // widened
    float thinnest_m;       // the smallest of them
    float reach;            // deviations at which nothing is left
};

struct Region {
    glm::vec3 centre_m;
    float edge_m;
};

class Voxeliser {
  public:
    Voxeliser(const Splats& splats, const SplatBox& kept, const CellBox& box, double cell_m, const std::string& file,
              const std::function<void()>& between)
        : degree_(splats.degree),
          low_m_(kept.low),
          high_m_(kept.high),
          box_(box),
          cell_m_(cell_m),
          file_(file),
          between_(between),
          most_leaves_(std::min<size_t>(
              voctree::kMaxLeaves, available_memory_bytes() / 4 /
                                       (sizeof(float) * StillLeaves{splats.degree, {}, {}}.values_of_leaf() + 64))) {
        for (const voctree::ShDirection& direction : voctree::sh_directions()) {
            bases_.push_back(voctree::sh_basis(direction.d));
            weights_.push_back(direction.weight);
        }
    }
    StillLeaves run(const std::vector<Blob>& blobs);

  private:
    struct Task {
        voctree::LeafPosition at;
        std::vector<uint32_t> blobs;
    };
    Region region_of(const voctree::LeafPosition& at) const;
    bool reaches(const Blob& blob, const Region& region) const;
    void descend(const std::vector<Blob>& blobs, const Task& from, uint32_t task_depth, std::vector<Task>* tasks,
                 StillLeaves& leaves) const;
    void add_leaf(const std::vector<Blob>& blobs, const Task& of, StillLeaves& leaves) const;
    void append_colours(const SplatColour& srgb, StillLeaves& leaves) const;
    float density_at(const Blob& blob, const Region& region) const;

    uint32_t degree_;
    glm::vec3 low_m_, high_m_;  // what is kept
    const CellBox& box_;
    double cell_m_;
    const std::string& file_;
    const std::function<void()>& between_;
    size_t most_leaves_;
    mutable std::atomic<size_t> leaf_count_ = 0;  // of all tasks
    Polylogarithm polylogarithm_;
    std::vector<std::array<double, kMaxShCount>> bases_;
    std::vector<double> weights_;
};

Region Voxeliser::region_of(const voctree::LeafPosition& at) const {
    const double edge = cell_m_ * std::exp2(box_.depth - at.depth);
    return {glm::vec3(glm::dvec3(box_.first) * cell_m_ + (glm::dvec3(at.x, at.y, at.z) + 0.5) * edge),
            static_cast<float>(edge)};
}

// Whether the sphere around a cell comes near enough.
bool Voxeliser::reaches(const Blob& blob, const Region& region) const {
    const float radius = 0.5f * std::numbers::sqrt3_v<float> * region.edge_m;
    const glm::vec3 offset = glm::abs((region.centre_m - blob.splat->centre) * blob.axes);
    const glm::vec3 deviations = glm::max(offset - radius, 0.0f) / blob.deviation_m;
    return glm::dot(deviations, deviations) < blob.reach * blob.reach;
}

// The mean over a cube of the cell's size along the splat's axes, by as many samples as its deviations ask for.
float Voxeliser::density_at(const Blob& blob, const Region& region) const {
    const glm::vec3 offset = (region.centre_m - blob.splat->centre) * blob.axes, own = blob.deviation_m;
    const glm::vec3 low = glm::max(offset - 0.5f * region.edge_m, -blob.reach * own);
    const glm::vec3 size = glm::min(offset + 0.5f * region.edge_m, blob.reach * own) - low;
    if (glm::any(glm::lessThanEqual(size, glm::vec3(0)))) return 0;
    const glm::ivec3 counts = glm::clamp(glm::ivec3(glm::ceil(size / (kDeviationsOfSample * own))), 1, kMostSamples);
    float sum = 0;
    for (int x = 0; x < counts.x; ++x)
        for (int y = 0; y < counts.y; ++y)
            for (int z = 0; z < counts.z; ++z) {
                const glm::vec3 at = (low + size * (glm::vec3(x, y, z) + 0.5f) / glm::vec3(counts)) / own;
                sum += polylogarithm_.at(std::min(blob.splat->opacity, kDensest) * std::exp(-0.5f * glm::dot(at, at)));
            }
    const glm::vec3 filled = size / region.edge_m / glm::vec3(counts);
    return sum * filled.x * filled.y * filled.z / (std::sqrt(2 * std::numbers::pi_v<float>) * blob.thinnest_m);
}

// The harmonics of a leaf for colours in sRGB.
void Voxeliser::append_colours(const SplatColour& srgb, StillLeaves& leaves) const {
    const uint32_t count = sh_count(degree_);
    for (int c = 0; c < 3; ++c) {
        std::array<double, kMaxShCount> k{};
        for (size_t d = 0; d < (degree_ == 0 ? 1 : bases_.size()); ++d) {
            double shown = 0.5;
            for (uint32_t i = 0; i < count; ++i)
                shown += double{kSignOfHarmonic[i]} * bases_[d][i] * double{srgb[i][c]};
            const double linear = std::clamp(media::linear_from_srgb(std::clamp(shown, 0.0, 1.0)),
                                             double{kLeastImportedColour}, 1 - double{kLeastImportedColour});
            const double logit = std::log(linear / (1 - linear));
            for (uint32_t i = 0; i < count; ++i) k[i] += weights_[d] * bases_[d][i] * logit;
            if (degree_ == 0) k[0] = logit / bases_[d][0];
        }
        for (uint32_t i = 0; i < count; ++i) leaves.values.push_back(static_cast<float>(k[i]));
    }
}

void Voxeliser::add_leaf(const std::vector<Blob>& blobs, const Task& of, StillLeaves& leaves) const {
    const Region region = region_of(of.at);
    if (glm::any(glm::lessThan(region.centre_m, low_m_)) || glm::any(glm::greaterThan(region.centre_m, high_m_)))
        return;
    SplatColour colour{};
    float sigma = 0;
    for (const uint32_t i : of.blobs) {
        const float density = density_at(blobs[i], region);
        sigma += density;
        for (uint32_t k = 0; k < sh_count(degree_); ++k) colour[k] += density * blobs[i].splat->colour[k];
    }
    if (!(-std::expm1(-sigma * region.edge_m) >= kLeastImportedOpacity) || !std::isfinite(sigma)) return;
    if (leaf_count_++ >= most_leaves_)
        throw InputError(file_, "", "has splats in more cells than there is memory for", Remedy::kFewerCells);
    for (glm::vec3& k : colour) k /= sigma;
    leaves.positions.push_back(of.at);
    leaves.values.push_back(sigma);
    append_colours(colour, leaves);
}

// Makes leaves of the blobs of a cell that reach it, or tasks of cells at `task_depth` that are to be done later.
void Voxeliser::descend(const std::vector<Blob>& blobs, const Task& from, uint32_t task_depth, std::vector<Task>* tasks,
                        StillLeaves& leaves) const {
    const Region region = region_of(from.at);
    const glm::vec3 half(0.5f * region.edge_m);
    if (glm::any(glm::lessThan(region.centre_m + half, low_m_)) ||
        glm::any(glm::greaterThan(region.centre_m - half, high_m_)))
        return;
    Task kept{from.at, {}};
    float thinnest_m = std::numeric_limits<float>::max();
    for (const uint32_t i : from.blobs)
        if (reaches(blobs[i], region)) {
            kept.blobs.push_back(i);
            thinnest_m = std::min(thinnest_m, blobs[i].thinnest_m);
        }
    if (kept.blobs.empty()) return;
    const bool is_fine = from.at.depth == box_.depth || region.edge_m <= kDeviationsOfCell * thinnest_m;
    if (from.at.depth > 0 && is_fine) {
        add_leaf(blobs, kept, leaves);
    } else if (tasks && from.at.depth == task_depth) {
        tasks->push_back(std::move(kept));
    } else {
        for (uint32_t i = 0; i < 8; ++i) {
            kept.at = {2 * from.at.x + (i & 1), 2 * from.at.y + (i >> 1 & 1), 2 * from.at.z + (i >> 2),
                       from.at.depth + 1};
            descend(blobs, kept, task_depth, tasks, leaves);
        }
    }
}

StillLeaves Voxeliser::run(const std::vector<Blob>& blobs) {
    StillLeaves all{degree_, {}, {}};
    std::vector<Task> tasks;
    Task root{{0, 0, 0, 0}, {}};
    for (uint32_t i = 0; i < blobs.size(); ++i) root.blobs.push_back(i);
    descend(blobs, root, std::min(kTaskDepth, box_.depth), &tasks, all);
    std::mutex mutex;
    parallel_for(tasks.size(), 1, [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) {
            between_();
            StillLeaves leaves{degree_, {}, {}};
            descend(blobs, tasks[t], 0, nullptr, leaves);
            const std::lock_guard lock(mutex);
            all.positions.insert(all.positions.end(), leaves.positions.begin(), leaves.positions.end());
            all.values.insert(all.values.end(), leaves.values.begin(), leaves.values.end());
        }
    });
    return all;
}

std::vector<Blob> blobs_of(const Splats& splats, double cell_m) {
    const float widening = kWideningOfCell * static_cast<float>(cell_m * cell_m);
    std::vector<Blob> blobs;
    for (const Splat& splat : splats.splats) {
        if (splat.opacity < kFaintestOpacity) continue;
        const glm::vec3 d = glm::sqrt(splat.deviation * splat.deviation + widening);
        blobs.push_back({&splat, glm::mat3_cast(splat.rotation), d, std::min({d.x, d.y, d.z}),
                         std::sqrt(2 * std::log(splat.opacity / kFaintestOpacity))});
    }
    return blobs;
}

// "splat 12 at (1, 2, 3)": the one in the box that is farthest from where most are; empty where there is none.
std::string farthest_place(const Splats& splats, const SplatBox& box) {
    std::vector<const Splat*> in;
    for (const Splat& splat : splats.splats) {
        const glm::dvec3 centre(splat.centre);
        if (glm::all(glm::greaterThanEqual(centre, box.low)) && glm::all(glm::lessThanEqual(centre, box.high)))
            in.push_back(&splat);
    }
    if (in.empty()) return "";
    glm::vec3 centre;
    for (int i = 0; i < 3; ++i) {
        const auto half = in.begin() + static_cast<ptrdiff_t>(in.size() / 2);
        std::nth_element(in.begin(), half, in.end(),
                         [i](const Splat* a, const Splat* b) { return a->centre[i] < b->centre[i]; });
        centre[i] = (*half)->centre[i];
    }
    return place_of(**std::max_element(in.begin(), in.end(), [&](const Splat* a, const Splat* b) {
        return glm::distance(a->centre, centre) < glm::distance(b->centre, centre);
    }));
}

}  // namespace

voctree::VOctree voxelised(const Splats& splats, const SplatBox& box, double cell_m, float fps, const std::string& file,
                           const std::function<void()>& between) {
    const glm::dvec3 low = glm::floor(box.low / cell_m), high = glm::floor(box.high / cell_m);
    constexpr double kMostCell = 1e8, kMostCells = 1 << 2 * kMaxNodeLevels;
    for (int i = 0; i < 3; ++i) {
        const bool is_far = !(std::abs(low[i]) < kMostCell) || !(std::abs(high[i]) < kMostCell);
        if (is_far || high[i] - low[i] >= kMostCells)
            throw InputError(file, farthest_place(splats, box),
                             is_far
                                 ? fmt::format("lies too far from the origin for cells of {:.3g} m", cell_m)
                                 : fmt::format("lies in a box of {:.0f} cells; a clip has at most {:.0f} along a side",
                                               high[i] - low[i], kMostCells),
                             Remedy::kFewerCells);
    }
    const CellBox cells = CellBox::around(low, high, 8, file, Remedy::kFewerCells);
    const StillLeaves leaves = Voxeliser(splats, box, cells, cell_m, file, between).run(blobs_of(splats, cell_m));
    return still_tree(leaves, cells, glm::dvec3(0), glm::dvec3(cell_m), fps);
}

}  // namespace neuvv::interchange
