#include "tools/report.h"

#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

namespace neuvv::tools {

std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string size_text(uint64_t bytes) {
    constexpr const char* kUnits[] = {"kB", "MB", "GB", "TB"};
    if (bytes < 1000) return fmt::format("{} B", bytes);
    double size = static_cast<double>(bytes) / 1000;
    size_t unit = 0;
    for (; size >= 1000 && unit + 1 < std::size(kUnits); ++unit) size /= 1000;
    return fmt::format("{:.1f} {}", size, kUnits[unit]);
}

bool trace_wanted() {
    const char* value = std::getenv("NEUVV_TRACE");
    return value && *value && std::string_view(value) != "0";
}

std::string pass_times_text(const std::vector<gpu::PassTime>& times) {
    std::string text;
    double sum = 0;
    for (const gpu::PassTime& pass : times) {
        text += fmt::format("{} {:.2f} ms, ", pass.name, pass.milliseconds);
        sum += pass.milliseconds;
    }
    return text + fmt::format("together {:.2f} ms", sum);
}

}  // namespace neuvv::tools
