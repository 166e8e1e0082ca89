// Tables of cameras with commas between the columns, as some programs write calibrations.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace neuvv::training {

struct TableForm {
    const char* header;  // how the line begins that names the columns, of which one is "name"
    std::span<const char*const> required, optional;  // columns of numbers
    const char* fix;                                 // what users do where a column is missing
};

struct TableRow {
    std::string name, place;               // the name without extension; "line 12"
    std::map<std::string, double> values;  // by column, all finite; a missing optional column is 0
};

// The rows of a table, at least one. Lines that begin with # are comments, but for the header. Throws InputError with
// file, line and column.
std::vector<TableRow> read_camera_table(const std::filesystem::path& path, const TableForm& form);

}  // namespace neuvv::training
