#include "training/rig/align_rig.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <set>

#include "base/error.h"

#include "render/frame/frame_renderer.h"
#include "training/evaluation/evaluate.h"
#include "training/rig/pose_solver.h"
#include "voctree/files/clip.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::training {

namespace {

constexpr size_t kViews = 16;
constexpr int kMostRounds = 8;
constexpr double kStepPixels = 1;  // by how much images move for a difference
constexpr double kMostPixels = 2;  // that a round moves images by one of the numbers
constexpr double kEnough = 0.01;   // pixels, below which a round ends the search

constexpr size_t kNumbers = kPoseNumbers;  // seven, as those of a camera
using Numbers = std::array<double, kNumbers>;

RigMotion motion_of(const Numbers& numbers) {
    return {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}, numbers[6]};
}

double mean_of(const std::vector<stage::Camera>& cameras, const std::function<double(const stage::Camera&)>& value) {
    double sum = 0;
    for (const stage::Camera& camera : cameras) sum += value(camera);
    return sum / static_cast<double>(cameras.size());
}

// By how much each number has to change for images to move by about kStepPixels.
Numbers steps_of(const std::vector<stage::Camera>& cameras, glm::dvec3 centre) {
    const double angle = kStepPixels / mean_of(cameras, [](const stage::Camera& camera) { return camera.fx; });
    const double shift = angle * mean_of(cameras, [&](const stage::Camera& c) { return distance_to(c, centre); });
    // To turn or to scale about the scene's centre moves what is far from it.
    const double about_centre = angle / kSceneExtent;
    return {about_centre, about_centre, about_centre, shift, shift, shift, about_centre};
}

// A view with its image over white, and the frame of the segment that it shows.
struct ComparedView {
    size_t view;
    float frame;
    media::Image truth;
};

// A segment's tree, and what is compared with it.
struct Scene {
    voctree::VOctree tree;
    std::vector<ComparedView> views;
};

// Up to kViews of a segment's views, spread over them by multiples of the golden ratio.
std::vector<ComparedView> selected_views(const std::vector<ViewFrame>& views, const Dataset& dataset) {
    std::set<size_t> selected;
    for (size_t i = 0; i < kViews; ++i) {
        const double share = std::fmod(static_cast<double>(i) * std::numbers::phi, 1.0);
        selected.insert(static_cast<size_t>(share * static_cast<double>(views.size())));
    }
    std::vector<ComparedView> compared;
    for (const size_t i : selected)
        compared.push_back({views[i].view, views[i].frame, truth_over(dataset, dataset.views[views[i].view])});
    return compared;
}

// Of the segments that the images show, the one nearest to the clip's centre that has leaves.
Scene scene_of(const voctree::ClipIndex& clip, const Dataset& dataset) {
    const std::vector<std::vector<ViewFrame>> views = views_by_segment(clip, dataset);
    for (const size_t i : voctree::segments_from_middle(clip.segments.size())) {
        if (views[i].empty()) continue;
        voctree::VOctree tree = voctree::read_shown_segment(clip.segments[i]);
        if (tree.leaf_count > 0) return {std::move(tree), selected_views(views[i], dataset)};
    }
    throw InputError(dataset.folder.string(), "", "has images only of times at which the scene shows nobody",
                     Remedy::kNotAligned);
}

// What one image says about the motion. `plus`, `minus`: renders with each number changed up and down by its step, so
// that the evidence is in steps.
void add_image(const media::Image& truth, const media::Image& render, const std::array<media::Image, kNumbers>& plus,
               const std::array<media::Image, kNumbers>& minus, PoseEvidence& evidence) {
    for (size_t i = 0; i < truth.rgba.size(); i += 4)
        for (size_t channel = i; channel < i + 3; ++channel) {
            const double error = (int{render.rgba[channel]} - int{truth.rgba[channel]}) / 255.0;
            Numbers derivatives;
            bool any = false;
            for (size_t number = 0; number < kNumbers; ++number) {
                const int difference = int{plus[number].rgba[channel]} - int{minus[number].rgba[channel]};
                derivatives[number] = difference / 510.0;
                any |= difference != 0;
            }
            if (any || error != 0)
                evidence.add(error, derivatives, kLargeError / std::max(std::abs(error), kLargeError));
        }
}

// The search: the cameras of the data set, and the views that it compares.
class Alignment {
  public:
    Alignment(const gpu::Device& device, const voctree::ClipIndex& clip, const Dataset& dataset,
              const AlignCallback& callback)
        : dataset_(dataset), callback_(callback), scene_(scene_of(clip, dataset)) {
        const auto [low, high] = voctree::occupied_box(scene_.tree);
        centre_ = 0.5 * (low + high);
        steps_ = steps_of(dataset.cameras, centre_);
        uint32_t width = 1, height = 1;
        for (const stage::Camera& camera : dataset.cameras)
            width = std::max(width, camera.width), height = std::max(height, camera.height);
        field_ = render::upload_field(device, scene_.tree, render::WeightPrecision::kHalf);
        renderer_.emplace(device, field_, render::FrameCapacity{width, height, 1});
    }

    RigAlignment operator()() {
        Numbers numbers{}, best{};
        double least = std::numeric_limits<double>::infinity();
        for (round_ = 0; round_ <= kMostRounds; ++round_) {
            const std::optional<PoseEvidence> evidence = look_from(numbers);
            if (!evidence) break;
            if (evidence->error < least) least = evidence->error, best = numbers;
            const Numbers change = solution_of(*evidence);
            double furthest = 0;
            for (size_t i = 0; i < kNumbers; ++i) {
                const double pixels = std::clamp(change[i], -kMostPixels, kMostPixels);
                numbers[i] += pixels * steps_[i];
                furthest = std::max(furthest, std::abs(pixels));
            }
            if (furthest < kEnough) break;
        }
        return found(motion_of(best));
    }

  private:
    // What all views say from a motion; nothing where the callback stopped the search.
    std::optional<PoseEvidence> look_from(const Numbers& numbers) {
        PoseEvidence evidence;
        for (size_t i = 0; i < scene_.views.size(); ++i) {
            const double done = static_cast<double>(i) / static_cast<double>(scene_.views.size());
            if (!callback_((round_ + done) / (kMostRounds + 1))) return std::nullopt;
            std::array<media::Image, kNumbers> plus, minus;
            for (size_t number = 0; number < kNumbers; ++number) {
                Numbers more = numbers, less = numbers;
                more[number] += steps_[number];
                less[number] -= steps_[number];
                plus[number] = rendered(scene_.views[i], more);
                minus[number] = rendered(scene_.views[i], less);
            }
            add_image(scene_.views[i].truth, rendered(scene_.views[i], numbers), plus, minus, evidence);
        }
        return evidence;
    }

    media::Image rendered(const ComparedView& one, const Numbers& numbers) {
        const View& view = dataset_.views[one.view];
        const stage::Camera camera = moved(dataset_.cameras[view.camera], motion_of(numbers), centre_);
        return render_over(*renderer_, camera, view, {{one.frame}}, 1);
    }

    RigAlignment found(const RigMotion& motion) const {
        double sum = 0;
        for (const stage::Camera& camera : dataset_.cameras) {
            const stage::Camera changed = moved(camera, motion, centre_);
            for (const glm::dvec3& point : scene_points(camera, centre_)) {
                const glm::dvec2 by = seen_at(changed, point) - seen_at(camera, point);
                sum += glm::dot(by, by);
            }
        }
        const double count = static_cast<double>(dataset_.cameras.size() * kScenePoints);
        return {motion, centre_, std::sqrt(sum / count)};
    }

    const Dataset& dataset_;
    const AlignCallback& callback_;
    glm::dvec3 centre_;
    Numbers steps_;
    Scene scene_;
    render::Field field_;
    std::optional<render::FrameRenderer> renderer_;
    int round_ = 0;
};

}  // namespace

stage::Camera moved(const stage::Camera& camera, const RigMotion& motion, glm::dvec3 centre) {
    const double angle = glm::length(motion.turn);
    const glm::dmat4 turn = angle > 0 ? glm::rotate(glm::dmat4(1), angle, motion.turn / angle) : glm::dmat4(1);
    stage::Camera result = camera;
    const glm::dvec3 arm = glm::dvec3(camera.world_from_camera[3]) - centre;
    result.world_from_camera = turn * camera.world_from_camera;
    const glm::dvec3 position = centre + std::exp(motion.log_scale) * glm::dmat3(turn) * arm + motion.shift;
    result.world_from_camera[3] = glm::dvec4(position, 1);
    return result;
}

RigAlignment align_rig(const gpu::Device& device, const voctree::ClipIndex& clip, const Dataset& dataset,
                       const AlignCallback& callback) {
    return Alignment(device, clip, dataset, callback)();
}

}  // namespace neuvv::training
