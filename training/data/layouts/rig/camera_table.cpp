#include "training/data/layouts/rig/camera_table.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "base/text.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/image_files.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxTableBytes = uint64_t{64} << 20;
constexpr const char* kByteOrderMark = "\xef\xbb\xbf";

double parse_number(const std::string& text, const std::string& file, const std::string& place) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        throw InputError(file, place, fmt::format("\"{:.40}\" is no number", text));
    return value;
}

// The position of each column, which users may choose in RealityCapture.
std::map<std::string, size_t> read_header(const std::vector<std::string>& fields, const std::string& file,
                                          const TableForm& form) {
    std::map<std::string, size_t> columns;
    for (size_t i = 0; i < fields.size(); ++i)
        columns.try_emplace(fields[i].starts_with('#') ? fields[i].substr(1) : fields[i], i);
    const auto expect = [&](const char* column) {
        if (!columns.contains(column))
            throw InputError(file, "header", fmt::format("has no column {}", column), form.fix);
    };
    expect("name");
    for (const char* column : form.required) expect(column);
    return columns;
}

TableRow read_row(const std::vector<std::string>& fields, const std::map<std::string, size_t>& columns,
                  const std::string& file, size_t line, const TableForm& form) {
    TableRow row;
    row.place = fmt::format("line {}", line);
    const auto field = [&](const std::string& column) -> const std::string& {
        const size_t at = columns.at(column);
        if (at >= fields.size())
            throw InputError(file, row.place, fmt::format("ends before its {}", column), "export the table again");
        return fields[at];
    };
    row.name = without_extension(portable_name(field("name")));
    for (const char* column : form.required)
        row.values[column] = parse_number(field(column), file, row.place + ", " + column);
    for (const char* column : form.optional)
        row.values[column] =
            columns.contains(column) ? parse_number(field(column), file, row.place + ", " + column) : 0;
    return row;
}

}  // namespace

std::vector<TableRow> read_camera_table(const std::filesystem::path& path, const TableForm& form) {
    const std::vector<uint8_t> bytes = read_file(path, kMaxTableBytes);
    const std::string file = path.string();
    std::map<std::string, size_t> columns;
    std::vector<TableRow> rows;
    size_t number = 0;
    for (std::string& line : split(std::string(bytes.begin(), bytes.end()), '\n')) {
        if (++number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, std::strlen(kByteOrderMark));
        if (line.ends_with('\r')) line.pop_back();
        if (line.empty()) continue;
        const std::vector<std::string> fields = split(line, ',');
        if (columns.empty() && line.starts_with(form.header))
            columns = read_header(fields, file, form);
        else if (!line.starts_with('#')) {
            if (columns.empty()) throw InputError(file, fmt::format("line {}", number), "stands before the header");
            rows.push_back(read_row(fields, columns, file, number, form));
        }
    }
    if (rows.empty()) throw InputError(file, "", "has no camera", form.fix);
    return rows;
}

}  // namespace neuvv::training
