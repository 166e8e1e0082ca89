// Which grids of an OpenVDB file are shown.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "interchange/volume/vdb_reader.h"

namespace neuvv::interchange {

struct VdbChoice {
    size_t density = 0;  // index of the grid
    std::optional<size_t> colour;
    std::vector<std::string> notes;  // what was chosen among several, and what is not shown
};

// By the rule of volume_of (vdb_volume.h). Throws InputError with `file` and the grids that are there.
VdbChoice choose_grids(std::span<const VdbGrid> grids, const std::string& file);

}  // namespace neuvv::interchange
