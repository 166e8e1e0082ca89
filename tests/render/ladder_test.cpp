// The choice of how many parts of a stream are taken, by traces that the player for browsers is tested by, too.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "render/clips/frame_pace.h"

namespace neuvv::test::ladder_test {
namespace {

using nlohmann::json;

json read_traces() {
    std::ifstream file(NEUVV_SOURCE_DIR "/tests/render/ladder_traces.json");
    return json::parse(file);
}

void learn(const json& step, render::FramePace& pace) {
    const json& took = step.at("learn");
    const stream::DecodeTimes decoded{took.at("shapes"), took.at("shapes_s"), took.at("planes_s"),
                                      took.at("plane_bytes")};
    for (int i = 0; i < step.at("times"); ++i) pace.learn(decoded, took.at("upload_s"));
}

uint32_t chosen_parts(const json& step, const json& group, render::FramePace& pace) {
    const stream::GroupCost cost{group.at("bytes_until"), group.at("frames"), group.at("seconds"), step.at("choose")};
    const json& rate = step.at("bytes_per_s");
    const auto bytes_per_s = rate.is_null() ? std::nullopt : std::optional<double>(rate);
    return pace.part_in_time(cost, bytes_per_s, step.at("at_s")) + 1;
}

// The steps of a trace that come out in another way than it says.
std::vector<std::string> differences(const json& trace, const json& group) {
    render::FramePace pace(trace.at("frames_at_once"));
    std::vector<std::string> found;
    for (const json& step : trace.at("steps")) {
        if (step.contains("learn")) {
            learn(step, pace);
        } else if (step.contains("arrives_s")) {
            for (int i = 0; i < step.at("times"); ++i) pace.learn_arrival(step.at("arrives_s"));
        } else if (step.contains("lead_s")) {
            const double lead_s = pace.lead_s();
            if (lead_s < step["lead_s"][0] || lead_s > step["lead_s"][1])
                found.push_back(step.dump() + ": " + std::to_string(lead_s));
        } else if (const uint32_t parts = chosen_parts(step, group, pace); parts != step.at("parts")) {
            found.push_back(step.dump() + ": " + std::to_string(parts));
        }
    }
    return found;
}

TEST(Ladder, ChoosesAsItsTracesSay) {
    const json all = read_traces();
    for (const json& trace : all.at("traces"))
        EXPECT_EQ(differences(trace, all.at("group")), std::vector<std::string>()) << trace.at("name");
}

TEST(Ladder, AnotherChoiceOrLeadIsADifference) {
    json all = read_traces();
    for (json& trace : all.at("traces")) {
        size_t changed = 0;
        for (json& step : trace.at("steps")) {
            changed += step.contains("parts") || step.contains("lead_s") ? 1 : 0;
            if (step.contains("parts")) step["parts"] = step["parts"].get<int>() + 1;
            if (step.contains("lead_s")) step["lead_s"] = {2, 3};
        }
        ASSERT_GT(changed, 0u);
        EXPECT_EQ(differences(trace, all.at("group")).size(), changed) << trace.at("name");
    }
}

}  // namespace
}  // namespace neuvv::test::ladder_test
