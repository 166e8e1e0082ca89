// What loading hostile files may end in.
#pragma once

#include <functional>
#include <string>

#include "stage/stage.h"
#include "training/dataset.h"
#include "voctree/paint.h"

namespace neuvv::fuzz {

// Empty where `load` gives sound cameras, or throws an InputError of one short line; else what is wrong.
std::string complaint_about(const std::function<training::Dataset()>& load);
// The same of a stage: everything that is drawn of it at any time is where numbers are finite.
std::string complaint_about_stage(const std::function<stage::Stage()>& load);
// Of a .nvv: every leaf is found where it stands, and its numbers are finite.
std::string complaint_about_clip(const std::function<voctree::VOctree()>& load);
// Of a .nvpaint: edits of leaves and frames that are there, with colours and densities that can be; and it can be
// edited on.
std::string complaint_about_paint(const std::function<voctree::EditLayer()>& load);

}  // namespace neuvv::fuzz
