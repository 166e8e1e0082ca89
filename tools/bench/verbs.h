// The verbs of neuvv-bench: each adds its subcommand with options, help and callback.
#pragma once

#include "tools/commands.h"

namespace neuvv::bench {

void add_open(CLI::App& app, const tools::CommonOptions& common);
void add_render(CLI::App& app, const tools::CommonOptions& common);
void add_slice(CLI::App& app, const tools::CommonOptions& common);
void add_walk(CLI::App& app, const tools::CommonOptions& common);
void add_instances(CLI::App& app, const tools::CommonOptions& common);
void add_stereo(CLI::App& app, const tools::CommonOptions& common);
void add_stage(CLI::App& app, const tools::CommonOptions& common);
void add_xr(CLI::App& app, const tools::CommonOptions& common);
void add_train(CLI::App& app, const tools::CommonOptions& common);
void add_edit(CLI::App& app, const tools::CommonOptions& common);

}  // namespace neuvv::bench
