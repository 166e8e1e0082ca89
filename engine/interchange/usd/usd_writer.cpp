#include "interchange/usd/usd_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

namespace neuvv::interchange {

void append_usd_values(std::string& text, const std::string& indent, const std::string& name,
                       const std::vector<std::string>& values) {
    const auto out = std::back_inserter(text);
    if (std::all_of(values.begin(), values.end(), [&](const std::string& value) { return value == values[0]; })) {
        fmt::format_to(out, "{}{} = {}\n", indent, name, values[0]);
        return;
    }
    fmt::format_to(out, "{}{}.timeSamples = {{\n", indent, name);
    for (size_t i = 0; i < values.size(); ++i) fmt::format_to(out, "{}    {}: {},\n", indent, i, values[i]);
    fmt::format_to(out, "{}}}\n", indent);
}

std::string usd_matrix(const glm::dmat4& matrix) {
    std::string text = "(";
    for (int row = 0; row < 4; ++row) {
        const glm::dvec4& v = matrix[row];  // a column of ours
        text += fmt::format("{}({:.12g}, {:.12g}, {:.12g}, {:.12g})", row > 0 ? ", " : "", v.x, v.y, v.z, v.w);
    }
    return text + ")";
}

std::string usd_quoted(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return quoted + "\"";
}

std::string UsdNames::take(const std::string& name) {
    std::string plain;
    for (const char c : name) plain += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    if (plain.empty() || std::isdigit(static_cast<unsigned char>(plain[0]))) plain = "_" + plain;
    std::string free = plain;
    for (int i = 1; !taken_.insert(free).second; ++i) free = fmt::format("{}_{}", plain, i);
    return free;
}

}  // namespace neuvv::interchange
