// neuvv stage info.
#pragma once

#include <CLI/CLI.hpp>

#include "render/frame.h"
#include "tools/commands.h"

namespace neuvv::tools {

struct StageInfoOptions {
    std::string stage;
    double at_s = 0, slice_budget_mb = static_cast<double>(render::kSliceBudget >> 20);
    bool json = false, memory = false;
};
// Also `neuvv info` of a stage.
void print_stage_info(const StageInfoOptions& options, const CommonOptions& common);
void add_stage_info(CLI::App& stage, CommonOptions& common);

}  // namespace neuvv::tools
