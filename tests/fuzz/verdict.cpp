#include "fuzz/verdict.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "base/error.h"
#include "stage/evaluated_stage.h"

namespace neuvv::fuzz {

namespace {

constexpr size_t kLongestMessage = 2000;

bool sound(const stage::Camera& camera) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(camera.world_from_camera[column][row])) return false;
    return camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy) &&
           std::isfinite(camera.cx) && std::isfinite(camera.cy) && camera.width > 0 && camera.height > 0;
}

bool finite(const glm::dmat4& matrix) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(matrix[column][row])) return false;
    return true;
}

std::string complaint_about_time(const stage::Stage& stage, double time_s) {
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, time_s);
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (performer.visible && !(finite(performer.world_from_performer) && performer.opacity >= 0))
            return "gave a performer that cannot be";
        if (!(performer.frame >= 0 && performer.frame <= static_cast<float>(stage.clips.at(performer.clip).frames - 1)))
            return "gave a frame outside of its clip";
    }
    for (const stage::EvaluatedLight& light : evaluated.lights)
        if (!(std::abs(glm::length(light.direction) - 1) < 1e-6 && std::isfinite(glm::length(light.position))))
            return "gave a light that cannot be";
    for (const stage::EvaluatedCamera& camera : evaluated.cameras)
        if (!camera.orthographic &&
            !sound(stage::camera_of(stage, std::to_string(&camera - evaluated.cameras.data()), evaluated, 8, 8)))
            return "gave a camera that cannot be";
    return {};
}

// Empty where `run` returns an empty string, or throws an InputError of one short line; else what is wrong.
std::string complaint_of(const std::function<std::string()>& run) {
    try {
        return run();
    } catch (const InputError& error) {
        const std::string text = error.what();
        if (text.find('\n') != std::string::npos) return "an InputError of several lines: " + text;
        if (text.size() > kLongestMessage) return "an InputError too long to read: " + text;
        return {};
    } catch (const std::exception& error) {
        return std::string("threw something else than InputError: ") + error.what();
    } catch (...) {
        return "threw something that is no exception";
    }
}

}  // namespace

std::string complaint_about(const std::function<training::Dataset()>& load) {
    return complaint_of([&]() -> std::string {
        const training::Dataset dataset = load();
        for (const stage::Camera& camera : dataset.cameras)
            if (!sound(camera)) return "gave a camera that cannot be";
        for (const training::View& view : dataset.views)
            if (!(view.time >= 0 && view.time <= 1)) return "gave a time outside [0,1]";
        return {};
    });
}

std::string complaint_about_stage(const std::function<stage::Stage()>& load) {
    return complaint_of([&]() -> std::string {
        const stage::Stage stage = load();
        std::string complaint;
        for (const double time_s : {0.0, 0.04, 1.0, 1e6})
            if (complaint.empty()) complaint = complaint_about_time(stage, time_s);
        if (complaint.empty() && stage::stage_bytes(stage.file) != stage.file.saved->bytes)
            complaint = "edited what it read";
        return complaint;
    });
}

std::string complaint_about_clip(const std::function<voctree::VOctree()>& load) {
    return complaint_of([&]() -> std::string {
        const voctree::VOctree tree = load();
        const auto finite = [](float number) { return std::isfinite(number); };
        for (const std::vector<float>* numbers : {&tree.weights, &tree.sigma_basis, &tree.gamma_basis})
            if (!std::all_of(numbers->begin(), numbers->end(), finite)) return "gave a number that is not finite";
        if (tree.weights.size() != size_t{tree.leaf_count} * tree.weights_per_leaf()) return "gave too few weights";
        const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
        if (positions.size() != tree.leaf_count) return "gave leaves without a position";
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
            const voctree::LeafPosition& at = positions[leaf];
            const glm::dvec3 centre =
                (glm::dvec3(at.x, at.y, at.z) + 0.5) * std::ldexp(1.0, -static_cast<int>(at.depth));
            if (voctree::find_leaf(tree, centre) != leaf) return "gave a leaf that is not found where it stands";
        }
        return {};
    });
}

std::string complaint_about_paint(const std::function<voctree::EditLayer()>& load) {
    return complaint_of([&]() -> std::string {
        voctree::EditLayer layer = load();
        const auto within = [](float number, float low, float high) { return number >= low && number <= high; };
        std::vector<uint32_t> odd;
        for (const voctree::LeafEdit& edit : layer.edits) {
            if (edit.leaf >= layer.field.leaf_count) return "gave paint on a leaf that does not exist";
            if (!within(edit.last, edit.first, static_cast<float>(layer.field.frames - 1)) || !(edit.first >= 0))
                return "gave paint at frames that do not exist";
            for (int c = 0; c < 3; ++c)
                if (!within(edit.colour[c], 0, 1)) return "gave a colour that cannot be";
            if (!within(edit.alpha, 0, 1)) return "gave an alpha that cannot be";
            if (edit.sigma != voctree::kKeepSigma && !within(edit.sigma, 0, 65504))
                return "gave a density that cannot be";
            if (edit.leaf % 2) odd.push_back(edit.leaf);
        }
        voctree::add_edits(layer, std::vector<voctree::LeafEdit>(layer.edits));
        voctree::remove_edits(layer, odd, 0.5f, 1);
        return voctree::defect_of(layer);
    });
}

std::string complaint_about_skeleton(const std::function<motion::SkeletonClip()>& load) {
    return complaint_of([&]() -> std::string {
        const motion::SkeletonClip clip = load();
        if (clip.frames.empty() || !(clip.fps > 0)) return "gave a clip without frames or rate";
        for (const motion::Pose& pose : clip.frames)
            for (const motion::JointSample& sample : pose)
                if (!std::isfinite(glm::length(sample.position)) || !(sample.confidence >= 0 && sample.confidence <= 1))
                    return "gave a joint that cannot be";
        return {};
    });
}

}  // namespace neuvv::fuzz
