#include "training/find_poses.h"

#include <algorithm>
#include <cmath>

#include "base/seconds.h"
#include "training/hull_box.h"
#include "training/pose_probe.h"
#include "training/schedule.h"

namespace neuvv::training {

namespace {

constexpr size_t kDraftTimes = 4;
// The draft is the beginning of a run, up to this progress: afterwards leaves become finer than pixels.
constexpr double kDraftEnd = 0.45;
constexpr double kDraftEpochs = 4;
constexpr double kMostOfBudget = 0.2;

constexpr uint32_t kRounds = 30;
constexpr double kFirstRound = 0.05;      // of the draft: before, there is hardly an image
constexpr uint32_t kTilesPerCamera = 48;  // of a round, all its times together
constexpr size_t kTimesPerRound = 2;

// By how much the draft's hull is wider than the mattes say, as a share of the median distance of the cameras: a camera
// that is turned by 0.3 degrees sees the performer so far from where it is. A hull that is too narrow has lost matter
// for good.
constexpr double kHullMargin = 0.0055;

// The times of the draft, evenly spaced over those of the clip.
std::vector<double> draft_times(const std::vector<double>& times) {
    const size_t count = std::min(times.size(), kDraftTimes);
    std::vector<double> chosen;
    for (size_t i = 0; i < count; i++) chosen.push_back(times[(2 * i + 1) * times.size() / (2 * count)]);
    return chosen;
}

// The images at those times alone, as a clip of its own.
Dataset at_times(const Dataset& dataset, const std::vector<double>& times) {
    Dataset part;
    part.folder = dataset.folder;
    part.cameras = dataset.cameras;
    part.plates = dataset.plates;
    part.box = dataset.box;
    part.fps = dataset.fps;
    for (size_t i = 0; i < times.size(); i++)
        part.times.push_back(times.size() > 1 ? static_cast<double>(i) / static_cast<double>(times.size() - 1) : 0);
    for (const View& view : dataset.views) {
        const auto found = std::ranges::find(times, view.time);
        if (found == times.end()) continue;
        part.views.push_back(view);
        part.views.back().time = part.times[static_cast<size_t>(found - times.begin())];
    }
    return part;
}

double hull_margin(const std::vector<stage::Camera>& cameras, glm::dvec3 centre) {
    std::vector<double> distances;
    for (const stage::Camera& camera : cameras) distances.push_back(distance_to(camera, centre));
    const auto middle = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return kHullMargin * *middle;
}

// The root of the mean square, over all cameras, of how far their images moved between two sets of changes.
double motion_between(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& from,
                      const std::vector<PoseChange>& to, glm::dvec3 centre) {
    double sum = 0;
    for (size_t camera = 0; camera < given.size(); camera++) {
        PoseChange by;
        for (size_t i = 0; i < kPoseNumbers; i++) by[i] = to[camera][i] - from[camera][i];
        sum += std::pow(image_motion(given[camera], by, centre), 2);
    }
    return std::sqrt(sum / static_cast<double>(given.size()));
}

// The search: what it knows of the cameras, and the draft's data set, whose cameras are moved as rounds find them.
class PoseSearch {
  public:
    PoseSearch(const Dataset& dataset, const TrainSettings& settings)
        : given_(dataset.cameras),
          draft_(at_times(dataset, draft_times(dataset.times))),
          settings_(settings),
          changes_(dataset.cameras.size()) {
        const auto [low, high] = first_box(draft_);
        centre_ = 0.5 * (low + high);
        minutes_ = settings.steps > 0 ? 0 : kMostOfBudget * (settings.minutes > 0 ? settings.minutes : kDefaultMinutes);
    }

    std::optional<std::vector<PoseChange>> operator()(const gpu::Device& device, const PoseSearchCallback& callback);

  private:
    TrainSettings draft_settings() const;
    double fraction(const BetweenSteps& now) const;
    void make_round(const BetweenSteps& now);

    const std::vector<stage::Camera>& given_;
    Dataset draft_;
    const TrainSettings& settings_;
    glm::dvec3 centre_;
    double minutes_;  // that the search may take; 0: any
    std::vector<PoseChange> changes_;
    double began_ = seconds_now();
    PoseSearchProgress progress_;
};

TrainSettings PoseSearch::draft_settings() const {
    TrainSettings draft;
    draft.tiles_per_step = std::max(settings_.tiles_per_step, kPoseVariants);
    const BatchSampler sampler(draft_, draft.tiles_per_step, settings_.seed);
    const double rays_per_step = static_cast<double>(draft.tiles_per_step) * kTilePixels;
    const double steps = kDraftEpochs * static_cast<double>(sampler.rays_per_epoch()) / rays_per_step;
    draft.steps = static_cast<uint64_t>(std::ceil(std::max(steps, double{2 * kRounds}) / kDraftEnd));
    draft.minutes = minutes_ / kDraftEnd;
    draft.shape = settings_.shape;
    draft.shape.hull_margin = hull_margin(given_, centre_);
    draft.seed = settings_.seed;
    draft.weights = settings_.weights;
    draft.refine = settings_.refine;
    return draft;
}

// How much of the draft is done: it ends where a run of its settings has come to kDraftEnd.
double PoseSearch::fraction(const BetweenSteps& now) const {
    return std::min(now.fraction / kDraftEnd, 1.0);
}

// Improves the poses by some tiles of each camera, at up to two times.
void PoseSearch::make_round(const BetweenSteps& now) {
    const uint32_t levels_above_pixel = kLevelsAbovePixel - std::min(now.phase, kLevelsAbovePixel);
    const PoseProbe probe{given_, changes_, now.colours, centre_, static_cast<double>(1u << levels_above_pixel)};
    const size_t count = std::min(draft_.times.size(), kTimesPerRound);
    std::vector<PoseEvidence> evidence(given_.size());
    for (size_t i = 0; i < count; i++) {
        const size_t time = (progress_.rounds * count + i) % draft_.times.size();
        const Batch batch =
            now.sampler.sample(time, kTilesPerCamera / static_cast<uint32_t>(count), settings_.seed + progress_.rounds);
        add_evidence(now.step, probe, batch, static_cast<float>(time), evidence);
    }
    const std::vector<PoseChange> before = changes_;
    changes_ = next_poses(given_, changes_, evidence, centre_, probe.pixels);
    draft_.cameras = moved(given_, changes_);
    progress_.rounds++;
    progress_.last_motion_px = motion_between(given_, before, changes_, centre_);
    progress_.motion_px = motion_between(given_, std::vector<PoseChange>(given_.size()), changes_, centre_);
}

std::optional<std::vector<PoseChange>> PoseSearch::operator()(const gpu::Device& device,
                                                              const PoseSearchCallback& callback) {
    bool stopped = false;
    TrainSettings draft = draft_settings();
    draft.between_steps = [&](const BetweenSteps& now) {
        progress_.fraction = fraction(now);
        const double due = kFirstRound + (1 - kFirstRound) * progress_.rounds / kRounds;
        if (progress_.rounds < kRounds && progress_.fraction >= due) make_round(now);
        return !stopped && progress_.fraction < 1;
    };
    train(device, draft_, draft, {}, [&](const TrainProgress& now) {
        progress_.elapsed_s = seconds_now() - began_;
        progress_.psnr = now.psnr;
        if (progress_.fraction > 0) progress_.eta_s = progress_.elapsed_s * (1 / progress_.fraction - 1);
        stopped = !callback(progress_);
        return !stopped;
    });
    if (stopped && progress_.fraction < 1) return std::nullopt;
    return changes_;
}

}  // namespace

std::optional<std::vector<PoseChange>> find_poses(const gpu::Device& device, const Dataset& dataset,
                                                  const TrainSettings& settings, const PoseSearchCallback& callback) {
    PoseSearch search(dataset, settings);
    return search(device, callback);
}

}  // namespace neuvv::training
