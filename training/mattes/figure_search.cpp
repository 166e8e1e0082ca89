#include "training/mattes/figure_search.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "base/threads/parallel.h"
#include "base/trace_file.h"
#include "training/mattes/colour_cut.h"
#include "training/tree/hull_of_most.h"

namespace neuvv::training {

namespace {

constexpr double kScaleOfLengths = 640;  // pixels along the longer side of the images that these lengths are for:
constexpr double kReach = 10;            // fragments that are nearer to each other belong to one body
constexpr double kGap = 4;               // half of a gap between fragments that background cannot pass
constexpr double kFirstSure = 16;        // further inside the first figure, there is no background
constexpr double kSure = 3;              // further inside the hull of figures, there is none, either
constexpr double kBeyond = 12;           // further outside of the figure, there is no performer
constexpr double kNear = 3;              // so near to a figure, a pixel is not taken for the background
constexpr double kSpeck = 40;            // pixels of a fragment that may be noise

// Of MatteSettings::threshold: for fragments, as no hull supports noise; and for what shows a background that was
// learnt.
constexpr double kFragmentShare = 0.75, kLearntShare = 1.5;
constexpr double kFirstDissent = 0.05, kDissent = 0.06;  // HullSettings::dissent
constexpr double kPixelsOfCell = 2.4;    // the side of the smallest cells of the first hull; half of it afterwards
constexpr uint32_t kFirstDivisions = 5;  // of the first hull
constexpr int kFigureRounds = 3;
constexpr size_t kMinSightings = 2;  // frames of a background's pixel

struct Lengths {
    uint32_t reach, gap, first_sure, sure, beyond, near, speck;
};

Lengths lengths_for(uint32_t longer_side) {
    const double scale = longer_side / kScaleOfLengths;
    const auto pixels = [&](double length) { return static_cast<uint32_t>(std::max(1.0, std::round(length * scale))); };
    return {.reach = pixels(kReach),
            .gap = pixels(kGap),
            .first_sure = pixels(kFirstSure),
            .sure = pixels(kSure),
            .beyond = pixels(kBeyond),
            .near = pixels(kNear),
            .speck = static_cast<uint32_t>(kSpeck * scale * scale)};
}

// The looks of a moment are on all cores already.
struct OneThreadOfOpenCv {
    int before = cv::getNumThreads();
    OneThreadOfOpenCv() { cv::setNumThreads(1); }
    ~OneThreadOfOpenCv() { cv::setNumThreads(before); }
    OneThreadOfOpenCv(const OneThreadOfOpenCv&) = delete;
    OneThreadOfOpenCv& operator=(const OneThreadOfOpenCv&) = delete;
};

PixelMask both(PixelMask a, const PixelMask& b) {
    for (size_t i = 0; i < a.size(); ++i) a.set[i] &= b.set[i];
    return a;
}

PixelMask either(PixelMask a, const PixelMask& b) {
    for (size_t i = 0; i < a.size(); ++i) a.set[i] |= b.set[i];
    return a;
}

// The hull of the masks of a moment's looks, by look. By centres, its cells are half as large.
std::vector<PixelMask> hull_of_looks(const std::vector<FigureCamera>& cameras,
                                     const std::pair<glm::dvec3, glm::dvec3>& box, const Moment& moment,
                                     std::vector<PixelMask> masks, HullSettings settings) {
    std::vector<CameraMask> seen;
    std::vector<stage::Camera> pinholes;
    for (size_t i = 0; i < moment.size(); ++i) {
        const FigureCamera& camera = cameras[moment[i].camera];
        seen.push_back({&camera.camera, std::move(masks[i]), &camera.unseen});
        pinholes.push_back(camera.camera);
    }
    settings.divisions = std::min(divisions_for(pinholes, box, kPixelsOfCell), kFirstDivisions) + settings.by_centres;
    return hull_of_most(seen, box, settings);
}

class FigureSearch {
  public:
    FigureSearch(std::vector<FigureCamera> cameras, const std::pair<glm::dvec3, glm::dvec3>& box,
                 const MatteSettings& settings, std::vector<Moment>& moments, const FigureProgress& progress)
        : cameras_(std::move(cameras)),
          box_(box),
          fragments_(settings),
          backgrounds_(settings),
          moments_(moments),
          progress_(progress) {
        fragments_.threshold *= kFragmentShare;
        backgrounds_.threshold *= kLearntShare;
        for (const FigureCamera& camera : cameras_) known_.emplace_back(camera.camera.width, camera.camera.height);
    }
    bool run();

  private:
    void begin(Moment& moment);
    void join_hull(Moment& moment);
    void drop_background(Look& look) const;
    void cut_again(Moment& moment, bool backgrounds_are_learnt);
    void learn_backgrounds();
    PixelMask differences_of(const Look& look) const;
    bool step_done() {
        return !progress_ || progress_(++steps_ / static_cast<double>(moments_.size() * (1 + 2 * kFigureRounds)));
    }
    static Lengths lengths_of(const Look& look) { return lengths_for(std::max(look.image.width, look.image.height)); }

    std::vector<FigureCamera> cameras_;
    std::vector<PixelMask> known_;  // by camera: where its background was learnt from frames without a figure
    std::pair<glm::dvec3, glm::dvec3> box_;
    MatteSettings fragments_, backgrounds_;
    std::vector<Moment>& moments_;
    const FigureProgress& progress_;
    double steps_ = 0;
};

std::vector<PixelMask> figures_of(const Moment& moment) {
    std::vector<PixelMask> figures;
    for (const Look& look : moment) figures.push_back(look.figure);
    return figures;
}

// For each look of a moment, on all cores.
template <typename Action>
void for_looks(Moment& moment, const Action& action) {
    parallel_for(moment.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) action(i, moment[i]);
    });
}

PixelMask FigureSearch::differences_of(const Look& look) const {
    const FigureCamera& camera = cameras_[look.camera];
    const BackgroundKind kind = kind_of_background(camera.is_clean);
    return both(differing_pixels(look.image, camera.background, kind, fragments_), inverse(camera.unseen));
}

// Steps 1 to 3.
void FigureSearch::begin(Moment& moment) {
    std::vector<PixelMask> fragments(moment.size()), parts(moment.size());
    for_looks(moment, [&](size_t i, Look& look) {
        const Lengths lengths = lengths_of(look);
        fragments[i] = differences_of(look);
        parts[i] = convex_parts(fragments[i], lengths.reach, lengths.speck);
    });
    if (moment.size() >= kMinFigureCameras)
        parts = hull_of_looks(cameras_, box_, moment, std::move(parts), {.dissent = kFirstDissent});
    for_looks(moment, [&](size_t i, Look& look) {
        const Lengths lengths = lengths_of(look);
        look.possible = std::move(parts[i]);
        look.figure = both(look.possible, fragments[i]);
        if (cameras_[look.camera].is_clean) return;
        look.figure = enclosed(closed(fragments[i], lengths.gap), look.possible);
        look.figure = cut_by_colour(look.image, {.sure = shrunk(look.figure, lengths.first_sure),
                                                 .probable = look.figure,
                                                 .possible = both(look.possible, grown(look.figure, lengths.beyond))});
    });
}

// By camera without a clean plate, the median of the frames in which no figure is near.
void FigureSearch::learn_backgrounds() {
    std::vector<std::vector<const Look*>> looks(cameras_.size());
    for (const Moment& moment : moments_)
        for (const Look& look : moment) looks[look.camera].push_back(&look);
    parallel_for(cameras_.size(), 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            if (cameras_[c].is_clean) continue;
            std::vector<PixelMask> covered;
            for (const Look* look : looks[c])
                covered.push_back(grown(either(look->figure, look->hull), lengths_of(*look).near));
            std::vector<uint8_t> values;
            for (size_t i = 0; i < known_[c].size(); ++i)
                for (size_t channel = 0; channel < 3; ++channel) {
                    values.clear();
                    for (size_t k = 0; k < looks[c].size(); ++k)
                        if (!covered[k][i]) values.push_back(looks[c][k]->image.rgba[4 * i + channel]);
                    known_[c].set[i] = values.size() >= kMinSightings && !cameras_[c].unseen[i];
                    if (!known_[c][i]) continue;
                    const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
                    std::ranges::nth_element(values, middle);
                    cameras_[c].background.rgba[4 * i + channel] = *middle;
                }
        }
    });
}

// Gives each figure what the figures of most cameras say of it.
void FigureSearch::join_hull(Moment& moment) {
    const bool enough = moment.size() >= kMinFigureCameras;
    std::vector<PixelMask> hulls = enough ? hull_of_figures(cameras_, box_, moment) : figures_of(moment);
    for_looks(moment, [&](size_t i, Look& look) {
        look.hull = std::move(hulls[i]);
        look.figure = either(std::move(look.figure), look.hull);
    });
}

// Takes what shows a known background from a figure and its hull.
void FigureSearch::drop_background(Look& look) const {
    const PixelMask& known = known_[look.camera];
    media::Image background = cameras_[look.camera].background;
    for (size_t i = 0; i < known.size(); ++i)
        if (!known[i]) std::copy_n(&look.image.rgba[4 * i], 4, &background.rgba[4 * i]);
    const PixelMask differs = differing_pixels(look.image, background, BackgroundKind::kMedian, backgrounds_);
    const PixelMask kept = either(differs, inverse(known));
    look.figure = both(std::move(look.figure), kept);
    look.hull = both(std::move(look.hull), kept);
}

void FigureSearch::cut_again(Moment& moment, bool backgrounds_are_learnt) {
    for_looks(moment, [&](size_t, Look& look) {
        const Lengths lengths = lengths_of(look);
        const bool is_clean = cameras_[look.camera].is_clean;
        if (backgrounds_are_learnt && !is_clean) drop_background(look);
        look.sure = shrunk(look.hull, lengths.sure);
        if (is_clean)
            look.figure = either(both(look.possible, differences_of(look)), look.sure);
        else
            look.figure = without_specks(
                cut_by_colour(look.image,
                              {look.sure, look.figure, both(look.possible, grown(look.figure, lengths.beyond))}),
                lengths.speck);
    });
}

bool FigureSearch::run() {
    for (Moment& moment : moments_) {
        begin(moment);
        if (!step_done()) return false;
    }
    for (int round = 0; round < kFigureRounds; ++round) {
        const bool learns = round > 0;  // the first figures lack too much
        for (Moment& moment : moments_) {
            join_hull(moment);
            if (!step_done()) return false;
        }
        if (learns) learn_backgrounds();
        for (Moment& moment : moments_) {
            cut_again(moment, learns);
            if (!step_done()) return false;
        }
    }
    return true;
}

}  // namespace

std::vector<PixelMask> hull_of_figures(const std::vector<FigureCamera>& cameras,
                                       const std::pair<glm::dvec3, glm::dvec3>& box, const Moment& moment) {
    return hull_of_looks(cameras, box, moment, figures_of(moment), {.dissent = kDissent, .by_centres = true});
}

bool find_figures(std::vector<FigureCamera> cameras, const std::pair<glm::dvec3, glm::dvec3>& box,
                  const MatteSettings& settings, std::vector<Moment>& moments, const FigureProgress& progress) {
    const TraceSpan span("find figures");
    const OneThreadOfOpenCv one;
    return FigureSearch(std::move(cameras), box, settings, moments, progress).run();
}

}  // namespace neuvv::training
