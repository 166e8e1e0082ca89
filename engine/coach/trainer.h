// The performer of a stage whose motion a trainee follows.
#pragma once

#include "motion/skeleton/skeleton.h"
#include "render/clips/stage_renderer.h"
#include "stage/evaluated_stage.h"

namespace neuvv::coach {

struct Trainer {
    uint32_t performer = 0;  // index into Stage::performers
    std::string name;        // of the performer
    motion::SkeletonClip skeleton;
};

// The file of a performer's skeleton: the one that the stage names, else the one beside its .nvv, which need not exist.
std::filesystem::path skeleton_file_of(const stage::Stage& stage, uint32_t performer);

// The performer of this name, or, for an empty name, the first that has a skeleton. Throws InputError where there is
// none, and where its file cannot be read.
Trainer read_trainer(const stage::Stage& stage, const std::string& name);

// The time of the performer's clip that is shown, seconds.
double clip_time_of(const stage::Stage& stage, const stage::EvaluatedPerformer& performer);

}  // namespace neuvv::coach
