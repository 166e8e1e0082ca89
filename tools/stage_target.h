// The stage that a verb of `neuvv stage` edits.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <string>

#include "stage/stage_file.h"

namespace neuvv::tools {

// The stage of a verb, and where it is saved.
struct StageTarget {
    std::string stage, output;
};
void add_target(CLI::App& verb, StageTarget& target);

void expect_stage_name(const std::string& option, const std::string& file);

// One operation, whose words are printed: nothing is saved that could not be loaded again, missing clips aside.
void edit_stage(const StageTarget& target, const std::function<std::string(stage::StageFile&)>& operation);

}  // namespace neuvv::tools
