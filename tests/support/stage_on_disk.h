// Writes a stage with one performer, as `neuvv stage new` and `neuvv stage add` do.
#pragma once

#include <filesystem>
#include <string>

#include "edit/operations.h"

namespace neuvv::test {

inline void write_stage(const std::filesystem::path& path, const std::filesystem::path& clip, const std::string& name,
                        const edit::Placement& placement = {}) {
    stage::StageFile file = edit::new_stage(path);
    edit::PerformerEdit performer;
    performer.clip = clip;
    edit::add_performer(file, name, performer, placement);
    stage::save_stage_file(file, path);
}

}  // namespace neuvv::test
