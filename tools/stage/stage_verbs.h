// What the files of `neuvv stage` share: how a verb edits its stage, and the options of its operations. At the end: the
// verbs that have files of their own.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "base/file_lock.h"
#include "edit/operations.h"
#include "render/volume/slices/slice_cache.h"
#include "stage/stage.h"
#include "tools/commands.h"

namespace neuvv::tools {

// The stage of a verb, and where it is saved.
struct StageTarget {
    std::string stage;
    std::string output;  // empty: where the stage was
};
void add_target(Command verb, StageTarget& target);

// Throws InputError where a file is not named .gltf or .glb.
void expect_stage_name(const std::string& option, const std::string& file);

// For an EditLock (base/file_lock.h): says that it waits.
std::function<void()> says_that_it_waits(const std::filesystem::path& file);

// Applies an operation, saves the stage and prints what the operation says that it did. Throws InputError, and saves
// nothing, where the stage could not be loaded again; clips may be missing.
void edit_stage(const StageTarget& target, const std::function<std::string(stage::StageFile&)>& operation);

// Adds a verb that edits a stage by `operation`. Its options, a StageTarget and more, live as long as the verb.
template <typename Options>
std::pair<Command, Options&> add_edit_verb(Command stage, const std::string& name, const std::string& help,
                                           std::string (*operation)(stage::StageFile&, const Options&)) {
    Command verb = stage.add_verb(name, help);
    const auto options = std::make_shared<Options>();
    add_target(verb, *options);
    verb.callback([options, operation] {
        edit_stage(*options, [&](stage::StageFile& file) { return operation(file, *options); });
    });
    return {verb, *options};
}

// Index into stage.performers of the performer whose node the user named, by name or index; without a name, of the only
// performer. Throws InputError naming the option, and the performers from which to choose.
uint32_t find_performer(const stage::Stage& stage, const std::string& option, const std::string& node);

// Throws InputError, which names the option, for a time after which nothing on the stage changes any more. What loops
// or spins changes for ever; where nothing ever changes, any time will do.
void expect_time_on_stage(const stage::Stage& stage, const std::string& option, double time_s);

// Appends what an operation did to what others did before it.
void append_change(std::string& changes, const std::string& change);

// "X,Y,Z"; throws InputError naming the option.
glm::dvec3 parse_vector(const std::string& option, const std::string& text);
// "R,G,B" linear, or an sRGB colour by name or #rrggbb; as linear RGB. Throws InputError naming the option.
glm::dvec3 parse_light_colour(const std::string& option, const std::string& text);

// Options that set the members of an operation; those that the user does not give leave them as they are.
void add_placement_options(Command verb, edit::Placement& placement);
bool is_given(const edit::Placement& placement);
void add_performer_options(Command verb, edit::PerformerEdit& edit);
void add_stage_options(Command verb, edit::StageEdit& edit);
void add_light_options(Command verb, edit::LightEdit& edit);

struct StageInfoOptions {
    std::string stage;
    double at_s = 0, slice_budget_mb = static_cast<double>(render::kSliceBudget >> 20);  // MiB
    bool json = false, memory = false;
};
// Also for `neuvv info` of a stage.
void print_stage_info(const StageInfoOptions& options, const CommonOptions& common);

void add_stage_info(Command stage, CommonOptions& common);
void add_camera_verb(Command stage);
void add_path_verb(Command stage);

}  // namespace neuvv::tools
