// neuvv stage camera, neuvv stage path.
#pragma once

#include <CLI/CLI.hpp>

namespace neuvv::tools {

void add_camera_verb(CLI::App& stage);
void add_path_verb(CLI::App& stage);

}  // namespace neuvv::tools
