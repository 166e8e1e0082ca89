// What the programs neuvv and neuvv-bench share: how they run a verb, and the options that several verbs have. At the
// end: the verbs of neuvv, each of which adds its subcommand with options, help and callback.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/command_line.h"
#include "voctree/files/plenoctree.h"

namespace neuvv::tools {

// Options that every verb has.
struct CommonOptions {
    std::string device;      // index or part of a name; empty: NEUVV_DEVICE, else the best
    std::string trace;       // where the trace is written; empty: nowhere
    bool overwrite = false;  // whether results that are there are replaced (tools/results.h)
};

// An option whose value is `on` or `off`; nothing where the user does not give it.
Option add_switch(Command verb, const std::string& name, std::optional<bool>& value, const std::string& help);

// An option whose value is one of `names`, which are in the order of the enumeration.
template <typename Enum>
Option add_choice(Command verb, const std::string& name, std::optional<Enum>& value, std::span<const char* const> names,
                  const std::string& help) {
    const auto choose = [&value, names](const std::string& text) {
        value = static_cast<Enum>(std::find(names.begin(), names.end(), text) - names.begin());
    };
    return verb.add_parsed_option(name, choose, help).one_of({names.begin(), names.end()});
}

// --samples, for the verbs that render: rays a pixel along each side.
constexpr uint32_t kDefaultSamples = 2;
Option add_samples_option(Command verb, uint32_t& samples);

// --far-levels, for the verbs that play; nothing: on.
void add_far_levels_option(Command verb, std::optional<bool>& far_levels);

// --slice-budget, for the verbs that play.
void add_slice_budget_option(Command verb, double& mebibytes);
inline uint64_t bytes_of_mebibytes(double mebibytes) {
    return static_cast<uint64_t>(mebibytes * 1048576);
}

// --format, for the verbs that read data sets.
void add_format_option(Command verb, std::string& format);
// --holdout, for those that tell training from test.
void add_holdout_option(Command verb, std::string& holdout);

// --up, for the verbs that take a PlenOctree.
void add_up_option(Command verb, std::optional<voctree::UpAxis>& up);
// The axis, or what is usual where none is given. Throws InputError where one is given and the clip is no PlenOctree.
voctree::UpAxis up_of(const std::filesystem::path& clip, std::optional<voctree::UpAxis> up);

void add_devices(Command app, CommonOptions& common);
void add_info(Command app, CommonOptions& common);
void add_capture(Command app, CommonOptions& common);
void add_dataset(Command app, CommonOptions& common);
void add_matte(Command app, CommonOptions& common);
void add_skeleton(Command app, CommonOptions& common);
void add_coach(Command app, CommonOptions& common);
void add_train(Command app, CommonOptions& common);
void add_cluster(Command app, CommonOptions& common);
void add_eval(Command app, CommonOptions& common);
void add_convert(Command app, CommonOptions& common);
void add_publish(Command app, CommonOptions& common);
void add_export(Command app, CommonOptions& common);
void add_import(Command app, CommonOptions& common);
void add_clip(Command app, CommonOptions& common);
void add_render(Command app, CommonOptions& common);
void add_stage(Command app, CommonOptions& common);
void add_paint(Command app, CommonOptions& common);
void add_view(Command app, CommonOptions& common);
void add_xr(Command app, CommonOptions& common);

}  // namespace neuvv::tools
