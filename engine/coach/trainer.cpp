#include "coach/trainer.h"

#include <fmt/format.h>

#include "base/error.h"
#include "motion/skeleton/skeleton_file.h"

namespace neuvv::coach {

namespace {

bool has_skeleton(const stage::Stage& stage, uint32_t performer) {
    std::error_code error;
    return !stage.performers[performer].skeleton.empty() ||
           std::filesystem::exists(skeleton_file_of(stage, performer), error);
}

}  // namespace

std::filesystem::path skeleton_file_of(const stage::Stage& stage, uint32_t performer) {
    const stage::StagePerformer& one = stage.performers[performer];
    return one.skeleton.empty() ? motion::skeleton_beside(stage.clips[one.clip].path) : one.skeleton;
}

Trainer read_trainer(const stage::Stage& stage, const std::string& name) {
    const std::string file = stage.file.path.string();
    for (uint32_t i = 0; i < stage.performers.size(); ++i) {
        if (name.empty() ? !has_skeleton(stage, i) : stage.performers[i].name != name) continue;
        const std::filesystem::path skeleton = skeleton_file_of(stage, i);
        if (!has_skeleton(stage, i))
            throw InputError(file, name, fmt::format("has no skeleton {}", skeleton.string()), Remedy::kMakeSkeleton);
        return {i, stage.performers[i].name, motion::read_skeleton(skeleton)};
    }
    if (name.empty()) throw InputError(file, "", "has no performer with a skeleton", Remedy::kMakeSkeleton);
    throw InputError(file, name, "is no performer of this stage", Remedy::kChoosePerformer);
}

double clip_time_of(const stage::Stage& stage, const stage::EvaluatedPerformer& performer) {
    return static_cast<double>(performer.frame) / stage.clips[performer.clip].fps;
}

}  // namespace neuvv::coach
