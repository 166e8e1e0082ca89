// Decides whether loading a damaged file ended in a permitted way.
#pragma once

#include <functional>
#include <string>

#include "motion/skeleton/skeleton.h"
#include "stage/stage.h"
#include "training/data/dataset.h"
#include "voctree/edit_layer.h"

namespace neuvv::fuzz {

// Empty where `load` returns valid cameras, or throws an InputError of one short line; else what is wrong.
std::string complaint_about(const std::function<training::Dataset()>& load);
// The same for a stage: at every time that is tested, everything that is drawn has a finite position.
std::string complaint_about_stage(const std::function<stage::Stage()>& load);
// The same for a .nvv: find_leaf finds every leaf at its position, and its numbers are finite.
std::string complaint_about_clip(const std::function<voctree::VOctree()>& load);
// The same for a .nvpaint: its edits are of leaves and frames that exist, with valid colours and densities, and further
// edits can be added.
std::string complaint_about_paint(const std::function<voctree::EditLayer()>& load);

// The same for a skeleton: it has frames, and every position is finite.
std::string complaint_about_skeleton(const std::function<motion::SkeletonClip()>& load);

}  // namespace neuvv::fuzz
