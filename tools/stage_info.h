// neuvv stage info.
#pragma once

#include <CLI/CLI.hpp>

#include "tools/commands.h"

namespace neuvv {

void add_stage_info(CLI::App& stage, CommonOptions& common);

}  // namespace neuvv
