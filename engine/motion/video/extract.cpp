#include "motion/video/extract.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>

#include "base/error.h"
#include "motion/skeleton/median.h"
#include "motion/video/bundle.h"
#include "motion/video/triangulate.h"

namespace neuvv::motion {

namespace {

constexpr double kTolerance = 0.03;  // of the body's height: key points further off contradict the other views
constexpr double kSwapGain = 0.5;    // left and right are exchanged where that leaves less than this of the error
constexpr double kGuess = 0.25;      // the confidence of joints that were interpolated
constexpr int kSwapRounds = 3;       // until nothing changes, at most

// The right joints of arms and of legs, which a detector exchanges with the left ones together.
constexpr std::array kArms = {Joint::kRightShoulder, Joint::kRightElbow, Joint::kRightWrist};
constexpr std::array kLegs = {Joint::kRightHip,  Joint::kRightKnee,   Joint::kRightAnkle,
                              Joint::kRightHeel, Joint::kRightBigToe, Joint::kRightSmallToe};

class Extractor {
  public:
    explicit Extractor(const Detections& detections) : seen_(detections) {}

    Extraction run(const ExtractOptions& options) {
        height_ = guessed_height(seen_.cameras, seen_.points);  // only for first tolerances
        triangulate_all();
        height_ = measured_height();
        for (int round = 0; round < kSwapRounds; ++round) {
            triangulate_all();
            if (exchange_swapped() == 0) break;
        }
        triangulate_all();
        interpolate();
        Extraction result;
        if (options.bundle) fit_over_time(seen_, used_, height_, clip_);
        result.quality = quality();
        result.clip = std::move(clip_);
        return result;
    }

  private:
    double measured_height() const {
        const double height = body_height(bone_lengths(clip_));
        if (!(height > 0))
            throw InputError("skeleton", "", "no frame shows a leg and a trunk in two views",
                             "look at the key points: are they of these images?");
        return height;
    }

    void triangulate_all() {
        clip_.fps = seen_.fps;
        clip_.frames.assign(seen_.frames, {});
        used_.assign(seen_.points.size(), {});
        triangulated_ = {};
        std::vector<KeyPoint> points(seen_.cameras.size());
        for (size_t f = 0; f < seen_.frames; ++f)
            for (size_t j = 0; j < kJoints; ++j) {
                for (size_t c = 0; c < points.size(); ++c) points[c] = seen_.in(f, c)[j];
                const auto found = triangulate(seen_.cameras, points, kTolerance * height_);
                if (!found) continue;
                clip_.frames[f][j] = {found->position, found->confidence, true};
                for (size_t c = 0; c < points.size(); ++c) used_[f * points.size() + c][j] = found->agrees[c];
                ++triangulated_[j];
            }
    }

    // The distance from a key point to a joint's image, metres; at most a few tolerances, so that one wild key point
    // does not decide.
    double distance(const stage::Camera& camera, const KeyPoint& point, const JointSample& joint) const {
        const auto shown = project(camera, joint.position);
        const double limit = 4 * kTolerance * height_;
        return shown ? std::min(limit, glm::distance(*shown, point.pixel) * metres_per_pixel(camera, joint.position))
                     : limit;
    }

    // Exchanges left and right of arms or legs in images where that fits what the other views agree on much better.
    // Returns how many were exchanged.
    size_t exchange_swapped() {
        size_t count = 0;
        for (size_t f = 0; f < seen_.frames; ++f)
            for (size_t c = 0; c < seen_.cameras.size(); ++c)
                for (const std::span<const Joint> right_side :
                     {std::span<const Joint>(kArms), std::span<const Joint>(kLegs)})
                    count += exchange(f, c, right_side);
        return count;
    }

    bool exchange(size_t frame, size_t camera, std::span<const Joint> right_side) {
        KeyPoints& points = seen_.in(frame, camera);
        double as_seen = 0, exchanged = 0;
        size_t count = 0;
        for (const Joint right : right_side) {
            for (const auto& [from, to] :
                 {std::pair{right, info_of(right).mirrored}, {info_of(right).mirrored, right}}) {
                const JointSample& own = at(clip_.frames[frame], from);
                const JointSample& other = at(clip_.frames[frame], to);
                const KeyPoint& point = points[index_of(from)];
                if (!(point.confidence > 0 && own.confidence > 0 && other.confidence > 0)) continue;
                as_seen += distance(seen_.cameras[camera], point, own);
                exchanged += distance(seen_.cameras[camera], point, other);
                ++count;
            }
        }
        const double noise = 0.5 * kTolerance * height_ * static_cast<double>(count);
        if (count < 2 || as_seen < noise || exchanged > kSwapGain * as_seen) return false;
        for (const Joint right : right_side)
            std::swap(points[index_of(right)], points[index_of(info_of(right).mirrored)]);
        // Exchanging twice is none.
        const std::array<size_t, 3> key = {frame, camera, index_of(right_side[0])};
        if (!exchanged_.erase(key)) exchanged_.insert(key);
        return true;
    }

    // Fills the frames in which a joint was not triangulated, between those in which it was.
    void interpolate() {
        for (size_t j = 0; j < kJoints; ++j) {
            std::vector<size_t> known;
            for (size_t f = 0; f < clip_.frames.size(); ++f)
                if (clip_.frames[f][j].confidence > 0) known.push_back(f);
            if (known.empty()) continue;
            for (size_t f = 0; f < clip_.frames.size(); ++f) {
                JointSample& sample = clip_.frames[f][j];
                if (sample.confidence > 0) continue;
                const auto after = std::ranges::lower_bound(known, f);
                const size_t to = after == known.end() ? known.back() : *after;
                const size_t from = after == known.begin() ? known.front() : *std::prev(after);
                const double share = from == to ? 0 : static_cast<double>(f - from) / static_cast<double>(to - from);
                sample.position = glm::mix(clip_.frames[from][j].position, clip_.frames[to][j].position, share);
                sample.confidence = kGuess;
                sample.measured = false;
            }
        }
    }

    ExtractQuality quality() const {
        ExtractQuality quality;
        quality.height_m = height_;
        quality.swapped = exchanged_.size();
        for (size_t j = 0; j < kJoints; ++j) {
            std::vector<double> errors;
            for (size_t f = 0; f < seen_.frames; ++f)
                for (size_t c = 0; c < seen_.cameras.size(); ++c) {
                    const KeyPoint& point = seen_.in(f, c)[j];
                    if (!(point.confidence > 0)) continue;
                    ++quality.key_points;
                    quality.outliers += !used_[f * seen_.cameras.size() + c][j];
                    if (clip_.frames[f][j].confidence > 0)
                        errors.push_back(distance(seen_.cameras[c], point, clip_.frames[f][j]) / height_);
                }
            quality.error[j] = median(errors);
            quality.known[j] = static_cast<double>(triangulated_[j]) / static_cast<double>(seen_.frames);
        }
        return quality;
    }

    Detections seen_;  // swapped arms and legs are exchanged in place
    SkeletonClip clip_;
    UsedPoints used_;
    double height_ = 0;
    std::set<std::array<size_t, 3>> exchanged_;   // frame, camera, first joint of what was exchanged
    std::array<size_t, kJoints> triangulated_{};  // frames, by joint
};

}  // namespace

Extraction extract_skeleton(const Detections& detections, const ExtractOptions& options) {
    return Extractor(detections).run(options);
}

}  // namespace neuvv::motion
