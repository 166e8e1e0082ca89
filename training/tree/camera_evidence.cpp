#include "training/tree/camera_evidence.h"

#include <algorithm>
#include <iterator>

#include "base/threads/parallel.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

using Box = std::pair<glm::dvec3, glm::dvec3>;

constexpr uint32_t kSmallSide = 160;                                     // pixels, of the longer side of an image
constexpr uint32_t kWideGrid = 32, kNarrowGrid = 40, kFillingGrid = 16;  // cells along each side
constexpr double kMostWrong = 0.4;     // of the images that see a cell which may hold matter
constexpr size_t kMinForeground = 30;  // pixels, for an image to say anything

uint32_t scale_of(const stage::Camera& camera) {
    return std::max(1u, (std::max(camera.width, camera.height) + kSmallSide - 1) / kSmallSide);
}

View small_view(const View& view, uint32_t scale) {
    const uint32_t width = (view.image.width() + scale - 1) / scale, height = (view.image.height() + scale - 1) / scale;
    media::Image small(width, height);
    view.image.for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* rgba) {
        uint8_t& alpha = small.at(x / scale, y / scale)[3];
        alpha = std::max(alpha, rgba[3]);
    });
    View result{view.name, view.camera, view.time, TiledImage(small)};
    if (view.ignored.empty()) return result;
    result.ignored.resize(size_t{width} * height);
    for (uint32_t y = 0; y < view.image.height(); ++y)
        for (uint32_t x = 0; x < view.image.width(); ++x)
            if (view.ignores(x, y)) result.ignored[size_t{y / scale} * width + x / scale] = true;
    return result;
}

bool is_inside(const Box& box, const HullCell& cell) {
    const glm::dvec3 centre(cell.centre);
    return glm::all(glm::greaterThan(centre, box.first)) && glm::all(glm::lessThan(centre, box.second));
}

}  // namespace

Dataset small_mattes(const Dataset& dataset) {
    Dataset small;
    small.folder = dataset.folder;
    small.format = dataset.format;
    small.times = dataset.times;
    small.box = dataset.box;
    std::vector<uint32_t> scales;
    for (stage::Camera camera : dataset.cameras) {
        const uint32_t scale = scale_of(camera);
        scales.push_back(scale);
        camera.width = (camera.width + scale - 1) / scale;
        camera.height = (camera.height + scale - 1) / scale;
        for (double* pixels : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *pixels /= scale;
        small.cameras.push_back(camera);
    }
    small.views.resize(dataset.views.size());
    parallel_for(dataset.views.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            small.views[i] = small_view(dataset.views[i], scales[dataset.views[i].camera]);
    });
    return small;
}

Box judged_box(const Dataset& dataset) {
    const Box box = first_box(dataset);
    if (!dataset.box) return box;
    const glm::dvec3 half = 0.5 * (box.second - box.first);
    return {box.first - half, box.second + half};
}

// Of these cells, those that at most `most` images deny.
std::vector<CameraEvidence::DeniedCell> CameraEvidence::cells_in(const std::vector<HullCell>& cells,
                                                                 size_t most) const {
    std::vector<std::optional<DeniedCell>> found(cells.size());
    parallel_for(cells.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            DeniedCell denied{cells[c], {}, 0};
            for (size_t i = 0; i < silhouettes_.size() && denied.by.size() <= most; ++i) {
                const Verdict verdict = training::judge(silhouettes_[i], cells[c]);
                if (verdict == Verdict::kBackground) denied.by.push_back(static_cast<uint16_t>(i));
                if (verdict == Verdict::kMatter) ++denied.witnesses;
            }
            if (denied.by.size() <= most) found[c] = std::move(denied);
        }
    });
    std::vector<DeniedCell> kept;
    for (std::optional<DeniedCell>& cell : found)
        if (cell) kept.push_back(std::move(*cell));
    return kept;
}

// Around the cells that may hold matter in the eyes of most images. Where few cameras look, two of them that see the
// body on one ray would be enough for a cell far from it.
Box CameraEvidence::box_around_body(const std::vector<DeniedCell>& cells) {
    const auto may_hold_matter = [](const DeniedCell& cell) {
        const auto against = static_cast<double>(cell.by.size()), in_favour = static_cast<double>(cell.witnesses);
        return cell.witnesses >= 2 && against <= kMostWrong * (against + in_favour);
    };
    size_t most = 0;
    for (const DeniedCell& cell : cells)
        if (may_hold_matter(cell)) most = std::max(most, cell.witnesses);
    Box box{glm::dvec3(1e30), glm::dvec3(-1e30)};
    for (const DeniedCell& cell : cells) {
        if (!may_hold_matter(cell) || 2 * cell.witnesses < most) continue;
        const glm::dvec3 centre(cell.cell.centre), radius(static_cast<double>(cell.cell.radius));
        box = {glm::min(box.first, centre - radius), glm::max(box.second, centre + radius)};
    }
    return box;
}

CameraEvidence::CameraEvidence(const Dataset& dataset, double time, const Box& box, size_t most_wrong)
    : dataset_(&dataset), silhouettes_(silhouettes_at(dataset, time)) {
    for (const Silhouette& silhouette : silhouettes_) {
        const stage::Camera& camera = *silhouette.camera;
        foreground_.push_back(silhouette.foreground.count({0, 0, camera.width, camera.height}));
    }
    // One image more may deny a cell, which then is the one that is judged.
    const std::vector<DeniedCell> wide = cells_in(grid_cells(box, kWideGrid), most_wrong + 1);
    const Box narrow = box_around_body(wide);
    std::vector<HullCell> filling;
    if (narrow.first.x < narrow.second.x) {
        cells_ = cells_in(grid_cells(narrow, kNarrowGrid), most_wrong + 1);
        filling = grid_cells(narrow, kFillingGrid);
    }
    narrow_cells_ = cells_.size();
    for (const DeniedCell& cell : wide)
        if (!is_inside(narrow, cell.cell)) cells_.push_back(cell);
    meets_narrow_.resize(silhouettes_.size());
    parallel_for(silhouettes_.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) meets_narrow_[i] = covered_pixels(silhouettes_[i], filling);
    });
}

bool CameraEvidence::says_something(size_t image) const {
    return foreground_[image] >= kMinForeground;
}

// Cells that no trusted image denies are possible. Those around the narrow grid, which others may not see, explain the
// rays that pass it by: else there would be matter close before each camera, where no other camera looks.
std::vector<size_t> CameraEvidence::unexplained_pixels_of(size_t from, size_t at,
                                                          const std::vector<bool>& trusted) const {
    std::vector<HullCell> narrow, around;
    for (size_t c = 0; c < cells_.size(); ++c)
        if (std::ranges::none_of(cells_[c].by, [&](uint16_t image) { return trusted[camera_of(image)]; }))
            (c < narrow_cells_ ? narrow : around).push_back(cells_[c].cell);
    const std::vector<bool> by_narrow = covered_pixels(silhouettes_[at], narrow);
    const std::vector<bool> by_others = covered_pixels(silhouettes_[at], around);
    const TiledImage& pixels = dataset_->views[silhouettes_[from].view].image;
    std::vector<size_t> unexplained;
    pixels.for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* rgba) {
        const size_t pixel = size_t{y} * pixels.width() + x;
        if (rgba[3] < kMatteThreshold || by_narrow[pixel]) return;
        if (meets_narrow_[at][pixel] || !by_others[pixel]) unexplained.push_back(pixel);
    });
    return unexplained;
}

std::optional<double> CameraEvidence::unexplained_at(uint32_t from, uint32_t at,
                                                     const std::vector<bool>& trusted) const {
    const stage::Camera &a = dataset_->cameras[from], &b = dataset_->cameras[at];
    if (a.width != b.width || a.height != b.height) return {};
    std::optional<size_t> image, place;
    for (size_t i = 0; i < silhouettes_.size(); ++i) {
        if (camera_of(i) == from && says_something(i)) image = i;
        if (camera_of(i) == at) place = i;
    }
    if (!image || !place) return {};
    const size_t count = unexplained_pixels_of(*image, *place, trusted).size();
    return static_cast<double>(count) / static_cast<double>(foreground_[*image]);
}

namespace {

// The images whose denial explains an unexplained pixel best: on the pixel's ray, cells that fewer images deny are more
// likely to hold the matter that is seen there.
struct PixelBlame {
    size_t deniers = 0;         // of the cells that fewest images deny; 0: none was found
    std::vector<uint64_t> who;  // one bit for each image
};

}  // namespace

// Adds to `denied`, by image, the share of the foreground of image `of` that it denies.
void CameraEvidence::blame_deniers(size_t of, const std::vector<size_t>& unexplained,
                                   const std::vector<std::vector<uint16_t>>& deniers,
                                   std::vector<double>& denied) const {
    const uint32_t width = silhouettes_[of].camera->width;
    std::vector<int32_t> index(size_t{width} * silhouettes_[of].camera->height, -1);
    for (size_t i = 0; i < unexplained.size(); ++i) index[unexplained[i]] = static_cast<int32_t>(i);
    std::vector<PixelBlame> blames(unexplained.size());
    for (size_t c = 0; c < cells_.size(); ++c) {
        const std::vector<uint16_t>& by = deniers[c];
        const PixelRectangle part = part_in_image(silhouettes_[of], cells_[c].cell);
        for (uint32_t y = part.y0; y < part.y1; ++y)
            for (uint32_t x = part.x0; x < part.x1; ++x) {
                const int32_t pixel = index[size_t{y} * width + x];
                if (pixel < 0 || (c >= narrow_cells_ && meets_narrow_[of][unexplained[static_cast<size_t>(pixel)]]))
                    continue;
                PixelBlame& blame = blames[static_cast<size_t>(pixel)];
                if (blame.deniers > 0 && blame.deniers < by.size()) continue;
                if (blame.deniers != by.size())
                    blame = {by.size(), std::vector<uint64_t>((silhouettes_.size() + 63) / 64)};
                for (const uint16_t image : by) blame.who[image / 64] |= uint64_t{1} << image % 64;
            }
    }
    for (const PixelBlame& blame : blames)
        for (size_t i = 0; i < denied.size() && blame.deniers > 0; ++i)
            if (blame.who[i / 64] >> i % 64 & 1)
                denied[i] += 1 / static_cast<double>(blame.deniers) / static_cast<double>(foreground_[of]);
}

std::vector<std::optional<CameraFit>> CameraEvidence::judge(const std::vector<bool>& trusted, bool blame) const {
    const size_t images = silhouettes_.size();
    std::vector<std::vector<uint16_t>> deniers;  // by cell, those that are trusted
    for (const DeniedCell& cell : cells_) {
        deniers.emplace_back();
        std::ranges::copy_if(cell.by, std::back_inserter(deniers.back()),
                             [&](uint16_t image) { return trusted[camera_of(image)]; });
    }
    std::vector<double> unexplained(images);
    std::vector<std::vector<double>> denied(images, std::vector<double>(images));  // of an image's foreground, by image
    const auto counts = [&](size_t image) { return trusted[camera_of(image)] && says_something(image); };
    parallel_for(images, 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            if (!counts(i)) continue;
            const std::vector<size_t> pixels = unexplained_pixels_of(i, i, trusted);
            unexplained[i] = static_cast<double>(pixels.size()) / static_cast<double>(foreground_[i]);
            if (blame && !pixels.empty()) blame_deniers(i, pixels, deniers, denied[i]);
        }
    });
    std::vector<std::optional<CameraFit>> fits(trusted.size());
    for (size_t i = 0; i < images; ++i) {
        double sum = 0, others = 0;
        for (size_t j = 0; j < images; ++j)
            if (j != i && counts(j)) {
                sum += denied[j][i];
                others += 1;
            }
        if (trusted[camera_of(i)] && others > 0) fits[camera_of(i)] = CameraFit{unexplained[i], sum / others};
    }
    return fits;
}

}  // namespace neuvv::training
