// What tests read of traces (`--trace`).
#pragma once

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace neuvv {

// The spans of a trace (Chrome's trace event format, microseconds), by lane and name.
inline std::map<std::string, std::vector<nlohmann::json>> spans_of(const nlohmann::json& trace) {
    std::map<int, std::string> lanes;
    for (const auto& event : trace.at("traceEvents"))
        if (event.at("ph") == "M") lanes[event.at("tid")] = event.at("args").at("name");
    std::map<std::string, std::vector<nlohmann::json>> spans;
    for (const auto& event : trace.at("traceEvents"))
        if (event.at("ph") == "X")
            spans[lanes.at(event.at("tid")) + ": " + event.at("name").get<std::string>()].push_back(event);
    return spans;
}

// Whether two spans have a time in common.
inline bool overlap(const nlohmann::json& a, const nlohmann::json& b) {
    const auto begin = [](const auto& span) { return span.at("ts").template get<double>(); };
    const auto end = [&](const auto& span) { return begin(span) + span.at("dur").template get<double>(); };
    return begin(a) < end(b) && begin(b) < end(a);
}

// How often the main thread recorded a frame while it had not waited for the one before yet. (lavapipe draws within the
// submission, so that nothing overlaps there that could be measured.) No device may be lost in the trace.
inline size_t frames_recorded_ahead(const std::string& trace_file) {
    auto spans = spans_of(nlohmann::json::parse(std::ifstream(trace_file)));
    std::map<double, int> changes;  // of the number of frames under way, by time
    for (const auto& span : spans["main thread: record a frame"]) changes[span.at("ts")] = 1;
    for (const auto& span : spans["main thread: wait for the device: frame"]) changes[span.at("ts")] = -1;
    size_t ahead = 0;
    int under_way = 0;
    for (const auto& [time, change] : changes) {
        ahead += change > 0 && under_way > 0;
        under_way += change;
    }
    return ahead;
}

}  // namespace neuvv
