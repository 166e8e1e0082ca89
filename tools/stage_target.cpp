#include "tools/stage_target.h"

#include <fmt/format.h>

#include "base/error.h"
#include "editor/open_file.h"
#include "stage/stage.h"
#include "tools/options.h"
#include "tools/report.h"

namespace neuvv::tools {

void add_target(CLI::App& verb, StageTarget& target) {
    verb.add_option("STAGE", target.stage, "The stage, .gltf or .glb")->required();
    verb.add_option("-o,--output", target.output, "Save it here; default: where it was");
}

void expect_stage_name(const std::string& option, const std::string& file) {
    if (!editor::has_stage_ending(file))
        throw InputError(option, file, "is no name for a stage", "end it in .gltf or .glb");
}

void edit_stage(const StageTarget& target, const std::function<std::string(stage::StageFile&)>& operation) {
    const std::string& output = target.output.empty() ? target.stage : target.output;
    if (!target.output.empty()) expect_stage_name("--output", output);
    stage::StageFile file = stage::read_stage_file(target.stage);
    stage::expect_sound_document(file);
    const std::string change = operation(file);
    stage::expect_sound_document(file);
    prepare_output_file("--output", output);
    stage::save_stage_file(file, output);
    fmt::print("{}: {}\n", output, change);
}

}  // namespace neuvv::tools
