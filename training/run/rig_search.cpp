#include "training/run/rig_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/seconds.h"
#include "training/rig/pose_probe.h"
#include "training/rig/time_probe.h"
#include "training/run/schedule.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

// The draft is the beginning of a run, up to this progress: afterwards leaves become finer than pixels.
constexpr double kDraftEnd = 0.45;
constexpr double kDraftEpochs = 4;
constexpr double kMostOfBudget = 0.2;

constexpr uint32_t kRounds = 30;
constexpr double kFirstRound = 0.05;      // of the draft: before, there is hardly an image
constexpr uint32_t kTilesPerCamera = 48;  // of a round, all its times together
constexpr size_t kFramesPerRound = 2;
constexpr uint32_t kRoundsForTime = 12;  // the last ones, whose mean says how late cameras are
constexpr double kLeastContrast = 0.25;  // of a camera whose performer moves between frames

// By how much the draft's hull is wider than the mattes say, as a share of the median distance of the cameras: a camera
// that is turned by 0.3 degrees sees the performer so far from where it is. A hull that is too narrow has lost matter
// for good.
constexpr double kHullMargin = 0.0055;

// How many tiles of the clip's images hold foreground at one of two frames alone: a cheap measure of motion.
std::vector<size_t> motion_after_frames(const Dataset& dataset) {
    std::vector<std::vector<const TiledImage*>> images(dataset.times.size());
    for (std::vector<const TiledImage*>& frame : images) frame.resize(dataset.cameras.size());
    for (const View& view : dataset.views) {
        const auto frame = std::ranges::find(dataset.times, view.time) - dataset.times.begin();
        images[static_cast<size_t>(frame)][view.camera] = &view.image;
    }
    std::vector<size_t> motion;
    for (size_t frame = 0; frame + 1 < images.size(); ++frame) {
        motion.push_back(0);
        for (size_t camera = 0; camera < dataset.cameras.size(); ++camera) {
            const TiledImage *before = images[frame][camera], *after = images[frame + 1][camera];
            if (!before || !after || before->groups().size() != after->groups().size()) continue;
            for (size_t i = 0; i < before->groups().size(); ++i)
                motion.back() += static_cast<size_t>(std::popcount(before->groups()[i].kept ^ after->groups()[i].kept));
        }
    }
    return motion;
}

// The frames of the draft: of either half of the clip two that follow each other, those between which most moves.
std::vector<size_t> draft_frames(const Dataset& dataset) {
    const size_t count = dataset.times.size();
    std::vector<size_t> frames;
    if (count <= 4) {
        for (size_t i = 0; i < count; ++i) frames.push_back(i);
        return frames;
    }
    const std::vector<size_t> motion = motion_after_frames(dataset);
    for (const auto& [begin, end] : {std::pair<size_t, size_t>{0, count / 2 - 1}, {count / 2, count - 1}}) {
        const auto first = motion.begin() + static_cast<ptrdiff_t>(begin);
        const auto most = std::max_element(first, motion.begin() + static_cast<ptrdiff_t>(end));
        frames.push_back(static_cast<size_t>(most - motion.begin()));
        frames.push_back(frames.back() + 1);
    }
    return frames;
}

// The images of those frames alone, as a clip of its own.
Dataset at_frames(const Dataset& dataset, const std::vector<size_t>& frames) {
    Dataset part;
    part.folder = dataset.folder;
    part.cameras = dataset.cameras;
    part.plates = dataset.plates;
    part.box = dataset.box;
    part.fps = dataset.fps;
    for (size_t i = 0; i < frames.size(); ++i) {
        const double time = frames.size() > 1 ? static_cast<double>(i) / static_cast<double>(frames.size() - 1) : 0;
        part.times.push_back(time);
        for (const View& view : dataset.views) {
            if (view.time != dataset.times[frames[i]]) continue;
            part.views.push_back(view);
            part.views.back().time = time;
        }
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

double root_mean_square(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

// By how many pixels images move between two sets of changes, by camera.
std::vector<double> motion_between(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& from,
                                   const std::vector<PoseChange>& to, glm::dvec3 centre) {
    std::vector<double> motion;
    for (size_t camera = 0; camera < given.size(); ++camera) {
        PoseChange by;
        for (size_t i = 0; i < kPoseNumbers; ++i) by[i] = to[camera][i] - from[camera][i];
        motion.push_back(image_motion(given[camera], by, centre));
    }
    return motion;
}

// The search: what it has found so far, and the draft's data set, whose cameras it moves.
class RigSearch {
  public:
    RigSearch(const Dataset& dataset, const TrainSettings& settings, bool move_cameras)
        : given_(dataset.cameras),
          frames_(draft_frames(dataset)),
          draft_(at_frames(dataset, frames_)),
          settings_(settings),
          move_cameras_(move_cameras),
          still_(dataset.cameras.size()) {
        const auto [low, high] = first_box(draft_);
        centre_ = 0.5 * (low + high);
        found_.changes.poses = still_;
        found_.motion_px.resize(still_.size());
        found_.psnr.resize(still_.size());
        if (settings.steps == 0)
            progress_.most_s = 60 * kMostOfBudget * (settings.minutes > 0 ? settings.minutes : kDefaultMinutes);
    }

    std::optional<RigFindings> operator()(const gpu::Device& device, const RigSearchCallback& callback);

  private:
    TrainSettings draft_settings() const;
    void make_round(const BetweenSteps& now);
    bool follow_each_other(uint32_t a, uint32_t b) const;
    void conclude_times();

    const std::vector<stage::Camera>& given_;
    std::vector<size_t> frames_;  // of the clip
    Dataset draft_;
    const TrainSettings& settings_;
    bool move_cameras_;
    const std::vector<PoseChange> still_;
    glm::dvec3 centre_;
    double began_ = seconds_now();
    RigFindings found_;
    std::vector<PoseChange> steady_;                   // before the last rounds
    std::vector<std::vector<TimeEvidence>> lateness_;  // of the last rounds, by camera
    RigSearchProgress progress_;
};

TrainSettings RigSearch::draft_settings() const {
    TrainSettings draft;
    draft.tiles_per_step = std::max(settings_.tiles_per_step, kPoseVariants);
    const BatchSampler sampler(draft_, draft.tiles_per_step, settings_.seed);
    const double rays_per_step = static_cast<double>(draft.tiles_per_step) * kTilePixels;
    const double steps = kDraftEpochs * static_cast<double>(sampler.rays_per_epoch()) / rays_per_step;
    draft.steps = static_cast<uint64_t>(std::ceil(steps / kDraftEnd));
    if (settings_.steps > 0)
        draft.steps = std::min(draft.steps,
                               static_cast<uint64_t>(kMostOfBudget * static_cast<double>(settings_.steps) / kDraftEnd));
    draft.steps = std::max(draft.steps, static_cast<uint64_t>(std::ceil(2 * kRounds / kDraftEnd)));
    const double minutes = settings_.minutes > 0 ? settings_.minutes : kDefaultMinutes;
    draft.minutes = settings_.steps > 0 ? 0 : kMostOfBudget * minutes / kDraftEnd;
    draft.shape = settings_.shape;
    draft.shape.hull_margin = hull_margin(given_, centre_);
    draft.seed = settings_.seed;
    draft.weights = settings_.weights;
    draft.refine = settings_.refine;
    draft.may_stay_coarse = false;  // the steps of the search follow the size of leaves
    return draft;
}

// Whether two frames of the draft are neighbours in the clip.
bool RigSearch::follow_each_other(uint32_t a, uint32_t b) const {
    return a < frames_.size() && b < frames_.size() && (frames_[a] == frames_[b] + 1 || frames_[b] == frames_[a] + 1);
}

// Improves the poses by some tiles of each camera, at up to two frames, which follow each other.
void RigSearch::make_round(const BetweenSteps& now) {
    const uint32_t levels_above_pixel = kLevelsAbovePixel - std::min(now.phase, kLevelsAbovePixel);
    const double pixels = 1u << levels_above_pixel;
    const std::vector<PoseChange> before = found_.changes.poses;
    const PoseProbe probe{given_, before, now.colours, centre_, pixels};
    const size_t count = std::min(frames_.size(), kFramesPerRound);
    const bool times_too = progress_.rounds + kRoundsForTime >= kRounds;
    std::vector<PoseEvidence> evidence(given_.size());
    std::vector<TimeEvidence> lateness(given_.size());
    for (size_t i = 0; i < count; ++i) {
        const auto frame = static_cast<uint32_t>((progress_.rounds * count + i) % frames_.size());
        const Batch batch = now.sampler.sample(frame, kTilesPerCamera / static_cast<uint32_t>(count),
                                               settings_.seed + progress_.rounds);
        add_evidence(now.step, probe, batch, static_cast<float>(frame), evidence);
        for (const uint32_t beside : {frame - 1, frame + 1})
            if (times_too && follow_each_other(frame, beside))
                // Seen from where the files have the camera: a pose that has moved hides how late it is.
                add_time_evidence(now.step, given_, now.colours, batch, frame, beside, lateness);
    }
    if (times_too) lateness_.push_back(lateness);
    if (move_cameras_) found_.changes.poses = next_poses(given_, before, evidence, centre_, pixels);
    draft_.cameras = moved(given_, found_.changes.poses);
    found_.psnr.clear();
    for (const PoseEvidence& one : evidence)
        found_.psnr.push_back(one.count > 0 ? -10 * std::log10(std::max(one.error / one.count, 1e-10)) : 0);
    found_.motion_px = motion_between(given_, still_, found_.changes.poses, centre_);
    ++progress_.rounds;
    progress_.motion_px = root_mean_square(found_.motion_px);
    progress_.last_motion_px = root_mean_square(motion_between(given_, before, found_.changes.poses, centre_));
    found_.pixels = pixels;
    constexpr uint32_t kSteadyFrom = kRounds - kRoundsForTime;
    if (progress_.rounds == kSteadyFrom) steady_ = found_.changes.poses;
    if (progress_.rounds > kSteadyFrom)
        found_.unsteady_px = root_mean_square(motion_between(given_, steady_, found_.changes.poses, centre_));
}

// What the last rounds say of shutters: of how late they are, the mean of the rounds, of the rest, all rounds together.
void RigSearch::conclude_times() {
    const size_t cameras = given_.size();
    found_.changes.frames_late.assign(cameras, 0);
    found_.changes.readout.assign(cameras, 0);
    found_.blur.assign(cameras, 0);
    found_.late_by.assign(cameras, std::numeric_limits<double>::infinity());
    found_.roll_by = found_.late_by;
    std::vector<double> blurs;  // of cameras whose frames are those of the draft
    std::vector<size_t> exposures_known;
    for (size_t camera = 0; camera < cameras; ++camera) {
        TimeEvidence all;
        double sum = 0, squares = 0, count = 0;
        for (const std::vector<TimeEvidence>& round : lateness_) {
            if (round[camera].contrast() < kLeastContrast) continue;
            const double late = round[camera].frames_late();
            sum += late, squares += late * late, count++;
            all += round[camera];
        }
        if (count < 2) continue;
        const double mean = sum / count;
        const Readout readout = all.readout();
        found_.changes.frames_late[camera] = mean;
        found_.changes.readout[camera] = std::clamp(readout.frames, -kLongestReadout, kLongestReadout);
        found_.late_by[camera] = std::sqrt(std::max(squares / count - mean * mean, 0.0) / (count - 1));
        found_.roll_by[camera] = readout.deviation;
        const bool known = found_.late_by[camera] < kMostDeviation;
        if (!known || is_late(found_, camera) || is_rolling(found_, camera)) continue;
        found_.blur[camera] = all.blur();
        blurs.push_back(found_.blur[camera]);
        exposures_known.push_back(camera);
    }
    if (blurs.empty()) return;
    const auto middle = blurs.begin() + static_cast<ptrdiff_t>(blurs.size() / 2);
    std::ranges::nth_element(blurs, middle);
    for (const size_t camera : exposures_known) found_.blur[camera] -= *middle;
}

std::optional<RigFindings> RigSearch::operator()(const gpu::Device& device, const RigSearchCallback& callback) {
    bool stopped = false;
    TrainSettings draft = draft_settings();
    draft.between_steps = [&](const BetweenSteps& now) {
        found_.colours = now.colours;
        // Rounds and changes of the tree are no progress of the draft, but take time of the run.
        const double spent = progress_.most_s > 0 ? (seconds_now() - began_) / progress_.most_s : 0;
        progress_.fraction = std::min(std::max(now.fraction / kDraftEnd, spent), 1.0);
        const double due = kFirstRound + (1 - kFirstRound) * progress_.rounds / kRounds;
        if (progress_.rounds < kRounds && progress_.fraction >= due) make_round(now);
        return progress_.fraction < 1 && !stopped;
    };
    train(device, draft_, draft, {}, [&](const TrainProgress& now) {
        progress_.steps = now.step;
        progress_.elapsed_s = seconds_now() - began_;
        if (progress_.fraction > 0) progress_.eta_s = progress_.elapsed_s * (1 / progress_.fraction - 1);
        if (progress_.most_s > 0)
            progress_.eta_s = std::min(progress_.eta_s, std::max(progress_.most_s - progress_.elapsed_s, 0.0));
        stopped = !callback(progress_);
        return !stopped;
    });
    if (progress_.rounds == 0) return std::nullopt;
    found_.whole = progress_.rounds == kRounds;
    found_.colours.join_exposures();
    conclude_times();
    return found_;
}

}  // namespace

std::optional<RigFindings> search_rig(const gpu::Device& device, const Dataset& dataset, const TrainSettings& settings,
                                      bool move_cameras, const RigSearchCallback& callback) {
    RigSearch search(dataset, settings, move_cameras);
    return search(device, callback);
}

bool is_late(const RigFindings& findings, size_t camera) {
    const double late = std::abs(findings.changes.frames_late[camera]), by = findings.late_by[camera];
    return by < kMostDeviation && late > kWorthFrames && late > kDeviations * by;
}

bool is_rolling(const RigFindings& findings, size_t camera) {
    const double readout = std::abs(findings.changes.readout[camera]);
    const double by = findings.roll_by[camera];
    return by < kMostRollDeviation && readout > kMostReadout && readout > kReadoutDeviations * by;
}

Refinement worthwhile(const RigFindings& findings) {
    Refinement what;
    what.colour = worthwhile(findings.colours);
    for (size_t camera = 0; camera < findings.motion_px.size(); ++camera)
        what.time |= is_late(findings, camera) || is_rolling(findings, camera);
    // Poses of a draft that ended early, whose leaves are coarse, or that still move are those of the draft, not of the
    // rig: cameras that stand exactly would be moved away.
    const double motion_px = root_mean_square(findings.motion_px);
    what.poses = findings.whole && motion_px > kWorthPixels * findings.pixels &&
                 findings.unsteady_px < kMostUnsteady * motion_px;
    what.time = what.time && findings.whole && !what.poses;  // a camera that stands elsewhere seems late
    return what;
}

}  // namespace neuvv::training
