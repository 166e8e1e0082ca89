// What `neuvv export` makes of a stage as a whole: a file each, or a folder.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/export/frame_export.h"

namespace neuvv::tools {

struct StageKind {
    const char* name;                           // for --as, without which none of them is meant
    std::vector<std::string> endings, options;  // no endings: the output is a folder
    // Writes the output of a stage, and returns what was written, for people; what is known beside the file's size is
    // added to `json`, and of a folder `files` and `bytes`, too. Throws InputError.
    std::string (*write)(const ExportOptions& options, const CommonOptions& common, nlohmann::ordered_json& json);
};

const std::vector<StageKind>& stage_kinds();

std::string write_layout(const ExportOptions& options, const CommonOptions& common, nlohmann::ordered_json& json);
std::string write_stage_with_splats(const ExportOptions& options, const CommonOptions& common,
                                    nlohmann::ordered_json& json);
std::string write_web_stage(const ExportOptions& options, const CommonOptions& common, nlohmann::ordered_json& json);

}  // namespace neuvv::tools
