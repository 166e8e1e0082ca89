// The layout of stages for OpenUSD.
#include <fmt/format.h>

#include "base/error.h"
#include "base/output_path.h"
#include "interchange/stage/stage_usd.h"
#include "stage/evaluated_stage.h"
#include "tools/export/stage_kinds.h"
#include "tools/results.h"

namespace neuvv::tools {

std::string write_layout(const ExportOptions& options, const CommonOptions&, nlohmann::ordered_json&) {
    const stage::Stage stage = stage::load_stage(options.scene);
    if (!options.splats.empty() && !std::filesystem::is_directory(options.splats))
        throw InputError("--splats", options.splats, "is no folder", "give the one that holds NAME.usda of performers");
    prepare_result("--output", options.output);
    interchange::write_stage_usda(options.output, stage, {options.fps.value_or(stage.fps), options.splats});
    const stage::EvaluatedStage first = stage::stage_at(stage, 0);
    return fmt::format("{} performers, {} lights, {} cameras for {:.6g} s", stage.performers.size(),
                       first.lights.size(), first.cameras.size(), stage.duration_s);
}

}  // namespace neuvv::tools
