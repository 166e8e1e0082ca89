// What loading a hostile data set may end in.
#pragma once

#include <functional>
#include <string>

#include "training/dataset.h"

namespace neuvv::fuzz {

// Empty where `load` gives sound cameras, or throws an InputError of one short line; else what is wrong.
std::string complaint_about(const std::function<Dataset()>& load);

}  // namespace neuvv::fuzz
