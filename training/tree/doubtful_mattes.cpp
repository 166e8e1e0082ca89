#include "training/tree/doubtful_mattes.h"

#include <algorithm>
#include <optional>

#include "base/threads/parallel.h"
#include "training/tree/hull_box.h"
#include "training/tree/silhouettes.h"

namespace neuvv::training {

namespace {

using Box = std::pair<glm::dvec3, glm::dvec3>;

constexpr size_t kMinImages = 5;
constexpr uint32_t kCoarseGrid = 20, kFineGrid = 40;  // cells along each side

// How many of the images that see a cell may be wrong about it: fewer than a quarter.
size_t allowed_errors(size_t seen) {
    return (seen - 1) / 4;
}

// A cell that holds matter unless the images against it are right. Images are numbered as the silhouettes of their
// time.
struct Candidate {
    HullCell cell{};
    std::vector<uint32_t> against;  // the images that show only background there
    size_t allowed = 0;             // allowed_errors()
};

// How many images may be against a candidate: none, which makes candidates the cells of the hull, or allowed_errors().
enum class Tolerance { kNone, kErrors };

std::optional<Candidate> candidate_of(const std::vector<Silhouette>& silhouettes, const HullCell& cell,
                                      Tolerance tolerance) {
    const size_t most = tolerance == Tolerance::kNone ? 0 : allowed_errors(silhouettes.size());
    Candidate candidate{cell, {}, 0};
    size_t matter = 0;
    for (uint32_t i = 0; i < silhouettes.size(); ++i) {
        const Verdict verdict = judge(silhouettes[i], cell);
        if (verdict == Verdict::kMatter) ++matter;
        if (verdict != Verdict::kBackground) continue;
        if (candidate.against.size() == most) return {};
        candidate.against.push_back(i);
    }
    if (matter < 2) return {};
    candidate.allowed = allowed_errors(matter + candidate.against.size());
    if (candidate.against.size() > candidate.allowed) return {};
    return candidate;
}

std::vector<Candidate> candidates_in(const std::vector<Silhouette>& silhouettes, const Box& box, uint32_t grid,
                                     Tolerance tolerance) {
    const std::vector<HullCell> cells = grid_cells(box, grid);
    std::vector<std::optional<Candidate>> found(cells.size());
    parallel_for(cells.size(), 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) found[i] = candidate_of(silhouettes, cells[i], tolerance);
    });
    std::vector<Candidate> candidates;
    for (std::optional<Candidate>& candidate : found)
        if (candidate) candidates.push_back(std::move(*candidate));
    return candidates;
}

// The box around the candidates' balls.
Box box_of(const std::vector<Candidate>& candidates) {
    Box box{glm::dvec3(1e30), glm::dvec3(-1e30)};
    for (const Candidate& candidate : candidates) {
        const glm::dvec3 centre(candidate.cell.centre), radius(static_cast<double>(candidate.cell.radius));
        box = {glm::min(box.first, centre - radius), glm::max(box.second, centre + radius)};
    }
    return box;
}

// The candidates of a fine grid: its box is found with a coarse one.
std::vector<Candidate> find_candidates(const std::vector<Silhouette>& silhouettes, const Box& first,
                                       Tolerance tolerance) {
    const std::vector<Candidate> coarse = candidates_in(silhouettes, first, kCoarseGrid, tolerance);
    if (coarse.empty()) return {};
    return candidates_in(silhouettes, box_of(coarse), kFineGrid, tolerance);
}

// What the images of one time say against each other.
class MatteComparison {
  public:
    MatteComparison(const Dataset& dataset, const std::vector<Silhouette>& silhouettes,
                    std::vector<Candidate> candidates)
        : dataset_(dataset),
          silhouettes_(silhouettes),
          candidates_(std::move(candidates)),
          doubted_(silhouettes.size()) {}

    // Whether the hull explains the foreground of all images, but for one at most.
    bool explains_nearly_all() const;
    // The most doubtful image among those that are still trusted, which is not trusted any more; nothing where all
    // others agree well enough.
    std::optional<DoubtfulMatte> doubt_next();
    // For each pixel of an image whether the hull of the trusted images lies behind it.
    std::vector<bool> covered_by_hull(const Silhouette& silhouette) const;

  private:
    bool in_hull(const Candidate& candidate) const {
        return std::all_of(candidate.against.begin(), candidate.against.end(), [&](uint32_t i) { return doubted_[i]; });
    }
    std::vector<HullCell> hull() const;
    bool is_missed(const Candidate& candidate, const std::vector<PixelSums>& unexplained) const;

    const Dataset& dataset_;
    const std::vector<Silhouette>& silhouettes_;
    std::vector<Candidate> candidates_;
    std::vector<bool> doubted_;  // by image
};

std::vector<HullCell> MatteComparison::hull() const {
    std::vector<HullCell> cells;
    for (const Candidate& candidate : candidates_)
        if (in_hull(candidate)) cells.push_back(candidate.cell);
    return cells;
}

std::vector<bool> MatteComparison::covered_by_hull(const Silhouette& silhouette) const {
    return covered_pixels(silhouette, hull());
}

bool MatteComparison::explains_nearly_all() const {
    std::vector<uint8_t> unexplained(silhouettes_.size());
    parallel_for(silhouettes_.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const std::vector<bool> covered = covered_by_hull(silhouettes_[i]);
            const TiledImage& image = dataset_.views[silhouettes_[i].view].image;
            image.for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* rgba) {
                if (rgba[3] >= kMatteThreshold && !covered[size_t{y} * image.width() + x]) unexplained[i] = 1;
            });
        }
    });
    return std::count(unexplained.begin(), unexplained.end(), uint8_t{1}) <= 1;
}

// Whether a candidate outside the hull is missed by more images than can be wrong.
bool MatteComparison::is_missed(const Candidate& candidate, const std::vector<PixelSums>& unexplained) const {
    size_t missing = 0;
    for (uint32_t i = 0; i < silhouettes_.size(); ++i) {
        const std::optional<PixelRectangle> image = image_of(silhouettes_[i], candidate.cell);
        if (image && unexplained[i].count(*image) > 0) ++missing;
    }
    return missing > candidate.allowed;
}

std::optional<DoubtfulMatte> MatteComparison::doubt_next() {
    const std::vector<PixelSums> unexplained = unexplained_pixels(dataset_, silhouettes_, hull());
    std::vector<size_t> emptied(silhouettes_.size());  // missed cells, by the images that emptied them
    size_t body = 0;
    for (const Candidate& candidate : candidates_) {
        if (in_hull(candidate)) {
            ++body;
        } else if (is_missed(candidate, unexplained)) {
            ++body;
            for (const uint32_t i : candidate.against)
                if (!doubted_[i]) ++emptied[i];
        }
    }
    const auto worst = static_cast<size_t>(std::max_element(emptied.begin(), emptied.end()) - emptied.begin());
    const float share = static_cast<float>(emptied[worst]) / static_cast<float>(std::max<size_t>(body, 1));
    if (share < kDoubtfulShare) return {};
    doubted_[worst] = true;
    return DoubtfulMatte{silhouettes_[worst].view, share};
}

void ignore_background(View& view, const std::vector<bool>& covered) {
    view.ignored.resize(covered.size());
    media::Image image = view.image.whole();
    for (size_t i = 0; i < covered.size(); ++i) {
        uint8_t& alpha = image.rgba[4 * i + 3];
        if (!covered[i] || alpha >= kMatteThreshold) continue;
        view.ignored[i] = true;
        alpha = 0;
    }
    view.image.store(image);
}

std::vector<DoubtfulMatte> ignore_doubtful_mattes_at(Dataset& dataset, double time, const Box& first) {
    const std::vector<Silhouette> silhouettes = silhouettes_at(dataset, time);
    if (silhouettes.size() < kMinImages) return {};
    // Nearly always nothing is wrong, and the hull, which is found faster, is enough to know.
    if (MatteComparison(dataset, silhouettes, find_candidates(silhouettes, first, Tolerance::kNone))
            .explains_nearly_all())
        return {};
    MatteComparison comparison(dataset, silhouettes, find_candidates(silhouettes, first, Tolerance::kErrors));
    std::vector<DoubtfulMatte> found;
    while (const std::optional<DoubtfulMatte> next = comparison.doubt_next()) found.push_back(*next);
    for (const Silhouette& silhouette : silhouettes)
        if (std::any_of(found.begin(), found.end(), [&](const DoubtfulMatte& d) { return d.view == silhouette.view; }))
            ignore_background(dataset.views[silhouette.view], comparison.covered_by_hull(silhouette));
    return found;
}

}  // namespace

std::vector<DoubtfulMatte> ignore_doubtful_mattes(Dataset& dataset) {
    const Box box = first_box(dataset);
    std::vector<DoubtfulMatte> found;
    for (const double time : dataset.times)
        for (const DoubtfulMatte& matte : ignore_doubtful_mattes_at(dataset, time, box)) found.push_back(matte);
    return found;
}

}  // namespace neuvv::training
