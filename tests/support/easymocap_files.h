// Writes calibrations as EasyMocap and OpenCV do.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace neuvv::test {

inline std::string yaml_matrix(const std::string& key, int rows, int columns, const std::vector<double>& data) {
    return fmt::format("{}: !!opencv-matrix\r\n  rows: {}\r\n  cols: {}\r\n  dt: d\r\n  data: [{:.10f}]\r\n", key, rows,
                       columns, fmt::join(data, ", "));
}

inline std::string yaml_names(const std::vector<std::string>& names) {
    std::string text = "%YAML:1.0\r\n---\r\nnames:\r\n";
    for (const std::string& name : names) text += fmt::format("  - \"{}\"\r\n", name);
    return text;
}

}  // namespace neuvv::test
