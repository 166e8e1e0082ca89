#include "report.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "script.h"

namespace neuvv::xr_runtime {

namespace {

using OrderedJson = nlohmann::ordered_json;

bool add(std::vector<Finding>& findings, Finding&& finding) {
    for (Finding& known : findings)
        if (known.function == finding.function && known.rule == finding.rule && known.text == finding.text) {
            ++known.count;
            return false;
        }
    findings.push_back(std::move(finding));
    return true;
}

OrderedJson json_of(const std::vector<Finding>& findings) {
    OrderedJson list = OrderedJson::array();
    for (const Finding& finding : findings)
        list.push_back({{"frame", finding.frame},
                        {"function", finding.function},
                        {"rule", finding.rule},
                        {"text", finding.text},
                        {"count", finding.count}});
    return list;
}

OrderedJson json_of(const Report& report) {
    OrderedJson json;
    json["violations"] = json_of(report.violations);
    json["warnings"] = json_of(report.warnings);
    json["frames"] = report.frames;
    json["frames_with_layers"] = report.frames_with_layers;
    json["states"] = report.states;
    json["haptics"] = OrderedJson::array();
    for (const HapticPulse& pulse : report.haptics)
        json["haptics"].push_back({{"frame", pulse.frame},
                                   {"path", pulse.path},
                                   {"amplitude", pulse.amplitude},
                                   {"duration_ns", pulse.duration_ns}});
    json["layers"] = OrderedJson::array();
    for (const SavedLayers& layers : report.layers) {
        OrderedJson fov = OrderedJson::array();
        const auto degrees = [](float radians) { return radians * 180 / 3.14159265358979f; };
        for (const XrFovf& one : layers.fov)
            fov.push_back(
                {degrees(one.angleLeft), degrees(one.angleRight), degrees(one.angleUp), degrees(one.angleDown)});
        json["layers"].push_back({{"frame", layers.frame},
                                  {"types", layers.types},
                                  {"depth", layers.has_depth},
                                  {"display_time", layers.display_time},
                                  {"format", name_of_format(layers.format)},
                                  {"blend", layers.blend},
                                  {"size", {layers.size.width, layers.size.height}},
                                  {"fov_deg", fov}});
    }
    json["actions"] = report.actions;
    json["bindings"] = OrderedJson::object();
    for (const auto& [profile, bindings] : report.bindings) {
        OrderedJson& list = json["bindings"][profile] = OrderedJson::array();
        for (const Report::Binding& binding : bindings)
            list.push_back({{"action", binding.action}, {"path", binding.path}});
    }
    json["resident_bytes"] = report.resident_bytes;
    json["destroyed_cleanly"] = report.is_destroyed_cleanly;
    return json;
}

}  // namespace

bool Report::add_violation(Finding finding) {
    const std::string line = fmt::format("xr-runtime: {}: {}\n", finding.function, finding.text);
    const bool is_new = add(violations, std::move(finding));
    if (is_new) std::fputs(line.c_str(), stderr);
    write();
    return is_new;
}

bool Report::add_warning(Finding finding) {
    return add(warnings, std::move(finding));
}

void Report::write() const {
    if (folder.empty()) return;
    const std::filesystem::path final_path = folder / "report.json", temporary = folder / "report.json.new";
    {
        std::ofstream stream(temporary);
        stream << json_of(*this).dump(1) << '\n';
        if (!stream) {
            fmt::print(stderr, "xr-runtime: cannot write {}\n", temporary.string());
            return;
        }
    }
    std::error_code error;
    std::filesystem::rename(temporary, final_path, error);
    if (error) fmt::print(stderr, "xr-runtime: cannot write {}: {}\n", final_path.string(), error.message());
}

}  // namespace neuvv::xr_runtime
