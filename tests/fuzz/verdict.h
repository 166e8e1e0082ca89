// What loading a hostile data set may end in.
#pragma once

#include <functional>
#include <string>

#include "stage/stage.h"
#include "training/dataset.h"

namespace neuvv::fuzz {

// Empty where `load` gives sound cameras, or throws an InputError of one short line; else what is wrong.
std::string complaint_about(const std::function<Dataset()>& load);
// The same of a stage: everything that is drawn of it at any time is where numbers are finite.
std::string complaint_about_stage(const std::function<Stage()>& load);

}  // namespace neuvv::fuzz
