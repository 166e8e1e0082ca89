#include "stage/time_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "support/input_error.h"

namespace neuvv {
namespace {

constexpr uint32_t kFrames = 10;
constexpr double kFps = 25;

stage::Timeline timeline(const std::string& text, uint32_t frames = kFrames, double fps = kFps) {
    return stage::timeline_of(stage::parse_time_map(text, "stage", "time"), frames, fps, "stage", "time");
}

// The frames of the clip that the stage's frames show, at the clip's rate.
std::vector<double> shown(const std::string& text, int count) {
    const stage::Timeline map = timeline(text);
    std::vector<double> frames;
    for (int i = 0; i < count; ++i) frames.push_back(stage::frame_at(map, i / kFps));
    return frames;
}

using Frames = std::vector<double>;

TEST(TimeMap, EveryOperatorByHand) {
    EXPECT_EQ(shown("", 12), (Frames{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9}));
    EXPECT_EQ(shown("offset:3f", 6), (Frames{0, 0, 0, 0, 1, 2}));
    EXPECT_EQ(shown("offset:-3f", 8), (Frames{3, 4, 5, 6, 7, 8, 9, 9}));
    EXPECT_EQ(shown("speed:2", 6), (Frames{0, 2, 4, 6, 8, 9}));
    EXPECT_EQ(shown("speed:0.5", 4), (Frames{0, 0.5, 1, 1.5}));
    EXPECT_EQ(shown("pause:2f:3f", 8), (Frames{0, 1, 2, 2, 2, 2, 3, 4}));
    EXPECT_EQ(shown("freeze:4f", 3), (Frames{4, 4, 4}));
    EXPECT_EQ(shown("clip:2f:5f", 5), (Frames{2, 3, 4, 4, 4}));
    EXPECT_EQ(shown("reverse", 11), (Frames{9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 0}));
    EXPECT_EQ(shown("jump:3f:7f", 7), (Frames{0, 1, 2, 7, 8, 9, 9}));
    EXPECT_EQ(shown("jump:3f:1f", 7), (Frames{0, 1, 2, 1, 2, 3, 4}));
    EXPECT_EQ(shown("loop", 12), (Frames{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1}));
    EXPECT_EQ(shown("loop:2f:5f", 7), (Frames{2, 3, 4, 2, 3, 4, 2}));
    EXPECT_EQ(shown("ping-pong:2f:5f", 7), (Frames{2, 3, 4, 3, 2, 3, 4}));
    EXPECT_EQ(shown("ping-pong:2f:3f", 3), (Frames{2, 2, 2}));
    EXPECT_EQ(shown("speed:0.5,hold", 5), (Frames{0, 0, 1, 1, 2}));
    EXPECT_EQ(shown("loop:0:0.08s", 4), (Frames{0, 1, 0, 1})) << "seconds at the clip's rate";
}

TEST(TimeMap, OperatorsEditWhatThoseBeforeThemLeft) {
    EXPECT_EQ(shown("clip:2f:5f,loop", 5), (Frames{2, 3, 4, 2, 3}));
    EXPECT_EQ(shown("loop,clip:8f:12f,reverse", 5), (Frames{1, 0, 9, 8, 8}));
    EXPECT_EQ(shown("loop:0:2f,speed:0.5,offset:2f", 8), (Frames{0, 0, 0, 0.5, 1, 1, 0, 0.5}))
        << "the last frame holds";
    EXPECT_EQ(shown("offset:2f,speed:0.5", 6), (Frames{0, 0, 0, 0, 0, 0.5}));
    EXPECT_EQ(shown("speed:0.5,offset:2f", 6), (Frames{0, 0, 0, 0.5, 1, 1.5}));
    EXPECT_EQ(shown("freeze:4f,reverse,speed:3", 2), (Frames{4, 4}));
    EXPECT_EQ(shown("hold,speed:0.5,offset:2f", 6), (Frames{0, 0, 0, 0, 1, 1})) << "hold goes last wherever it stands";
    EXPECT_EQ(shown("offset:0.5f,hold,loop", 4), (Frames{0, 0, 1, 2}));
    EXPECT_EQ(shown("reverse,speed:0.5,hold", 5), (Frames{9, 8, 8, 7, 7}));
}

TEST(TimeMap, PeriodsAreThoseOfWhatIsShown) {
    const std::pair<const char*, double> periods[] = {{"", 0},
                                                      {"speed:0.5", 0},
                                                      {"loop", 10},
                                                      {"speed:0.5,loop", 20},
                                                      {"loop,speed:4", 2.5},
                                                      {"loop:2f:5f,offset:3f", 3},
                                                      {"ping-pong", 18},
                                                      {"ping-pong:2f:3f", 0},
                                                      {"loop,freeze:3f", 0},
                                                      {"loop,clip:1f:14f", 0},
                                                      {"loop,clip:1f:14f,loop", 13},
                                                      {"loop,pause:4f:6f", 10}};
    for (const auto& [text, frames] : periods) {
        const stage::Timeline map = timeline(text);
        const double period = stage::period_s(map);
        EXPECT_NEAR(period * kFps, frames, 1e-9) << text;
        for (int i = 30; i < 60 && period > 0; ++i)
            EXPECT_NEAR(stage::frame_at(map, i / kFps), stage::frame_at(map, i / kFps + period), 1e-6)
                << text << " at " << i;
    }
}

TEST(TimeMap, PartsBeyondTheEndAreReported) {
    const auto check = [](const char* text) { stage::expect_parts_within(timeline(text), "--time", text); };
    for (const char* text :
         {"loop:0:10f", "loop:0:0.4s", "clip:8f:10f", "loop,clip:8f:14f", "ping-pong", "offset:2f,loop:0:12f"})
        EXPECT_NO_THROW(check(text)) << text;
    expect_input_error([&] { check("loop:0:100s"); }, {"--time", "2500", "10", "end it at 10f", "pause:10f"});
    expect_input_error([&] { check("clip:0:8f,ping-pong:2f:9f"); }, {"/1", "8f"});
}

TEST(TimeMap, SpacesAreAllowed) {
    EXPECT_EQ(stage::parse_time_map(" loop : 0:2s , speed:0.5", "f", "p"),
              stage::parse_time_map("loop:0:2s,speed:0.5", "f", "p"));
    expect_input_error([&] { stage::parse_time_map("lo op", "f", "p"); }, {"lo op"});
}

TEST(TimeMap, TheEndsHoldAtAnyTime) {
    for (const char* text : {"", "loop", "reverse", "ping-pong", "offset:-400s", "offset:-400s,loop", "offset:400s",
                             "speed:1000,speed:1000,loop", "speed:0.001,ping-pong", "jump:1f:9f,loop", "pause:900s:2s",
                             "clip:20f:40f,loop", "clip:0:0.00001f,loop,speed:1000"})
        for (const double t : {-1e308, -1e9, -1.0, -1e-9, 0.0, 0.039999999999, 0.1, 3.0, 1e4, 1e9, 1e17, 1e308}) {
            const double frame = stage::frame_at(timeline(text), t);
            EXPECT_TRUE(frame >= 0 && frame <= kFrames - 1) << text << " at " << t << ": " << frame;
        }
    EXPECT_EQ(stage::frame_at(timeline(""), -5), 0);
    EXPECT_EQ(stage::frame_at(timeline("reverse"), -5), 9);
    EXPECT_EQ(stage::frame_at(timeline("loop", 1), 17.3), 0);
}

// Whole frames of the stage show whole frames of the clip, however many have passed and however odd the rates are.
TEST(TimeMap, RoundingMixesNoFrames) {
    for (const double fps : {23.976, 24.0, 25.0, 29.97, 30.0, 59.94, 90.0, 1000.0 / 41})
        for (const uint32_t frames : {7u, 24u, 75u})
            for (const int k : {0, 1, 6, 7, 8, 74, 75, 76, 524, 525, 99999, 1234567}) {
                const double t = k / fps;
                const auto n = static_cast<int>(frames);
                const auto at = [&](const char* text) { return stage::frame_at(timeline(text, frames, fps), t); };
                EXPECT_EQ(at("loop"), k % n) << fps << ' ' << frames << ' ' << k;
                EXPECT_EQ(at("reverse"), std::max(0, n - 1 - k));
                EXPECT_EQ(at("speed:0.5"), std::min(k / 2.0, n - 1.0));
                const int wave = k % (2 * (n - 1));
                EXPECT_EQ(at("ping-pong"), std::min(wave, 2 * (n - 1) - wave));
            }
    EXPECT_EQ(stage::frame_at(timeline(""), (3 + 0.9e-6) / kFps), 3);
    EXPECT_GT(stage::frame_at(timeline(""), (3 + 2e-6) / kFps), 3);
}

// A brute-force reference: a clip is the list of the frames that it shows, and operators cut and paste lists. It has
// whole frames only, and speeds that take every second or third frame or show each frame twice without mixing frames.
struct Cutting {
    Frames frames;
    bool endless = false;
    double at(size_t i) const {
        if (frames.empty()) return 0;
        return endless ? frames[i % frames.size()] : frames[std::min(i, frames.size() - 1)];
    }
    Frames part(size_t a, size_t b) const {
        Frames out;
        for (size_t i = a; i < b; ++i) out.push_back(at(i));
        return out;
    }
};

void cut(Cutting& clip, stage::TimeOperator& op, std::mt19937& random) {
    const auto below = [&](size_t end) { return random() % end; };
    if (clip.endless) clip.frames = clip.part(0, 2000), clip.endless = false;  // long enough for this test
    const size_t size = clip.frames.size();
    const size_t a = below(std::min<size_t>(size, 12)), b = a + 1 + below(6);
    op.a = {static_cast<double>(a), true};
    op.b = {static_cast<double>(b), true};
    Frames& frames = clip.frames;
    const auto insert = [&](size_t at, size_t count, double value) {
        frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(std::min(at, frames.size())), count, value);
    };
    switch (op.verb) {
        case stage::TimeVerb::kOffset:
            op.a.value = static_cast<double>(below(5));
            insert(0, static_cast<size_t>(op.a.value), frames[0]);
            break;
        case stage::TimeVerb::kSpeed: {
            op.factor = static_cast<double>(1 + below(3));
            Frames fewer;
            for (size_t i = 0; i < size; i += static_cast<size_t>(op.factor)) fewer.push_back(frames[i]);
            if (op.factor > 1) fewer.push_back(frames.back());  // shown after the end
            frames = fewer;
            break;
        }
        case stage::TimeVerb::kPause:
            op.b.value = static_cast<double>(below(4));
            insert(a, static_cast<size_t>(op.b.value), frames[a]);
            break;
        case stage::TimeVerb::kFreeze:
            frames.assign(size, frames[a]);
            break;
        case stage::TimeVerb::kClip:
            frames = clip.part(a, b);
            break;
        case stage::TimeVerb::kReverse:
            std::reverse(frames.begin(), frames.end());
            break;
        case stage::TimeVerb::kJump: {
            op.b.value = static_cast<double>(below(std::min<size_t>(size, 12)));
            Frames jumped = clip.part(0, a);
            const Frames rest = clip.part(static_cast<size_t>(op.b.value), size);
            jumped.insert(jumped.end(), rest.begin(), rest.end());
            frames = jumped;
            break;
        }
        case stage::TimeVerb::kLoop:
            frames = clip.part(a, b);
            clip.endless = true;
            break;
        case stage::TimeVerb::kPingPong: {
            Frames there = clip.part(a, b);
            for (size_t i = b - 1; i-- > a + 1;) there.push_back(clip.at(i));
            frames = there;
            clip.endless = true;
            break;
        }
        case stage::TimeVerb::kHold:  // is not among the operators that are drawn
            break;
    }
}

TEST(TimeMap, CompositionsAgainstCuttingAndPasting) {
    std::mt19937 random(11);
    int compared = 0;
    for (int round = 0; round < 3000; ++round) {
        Cutting clip;
        for (int i = 0; i < static_cast<int>(kFrames); ++i) clip.frames.push_back(i);
        stage::TimeMap map;
        bool was_endless = false;
        for (size_t count = 1 + random() % 5; map.size() < count;) {
            stage::TimeOperator op;
            op.verb = static_cast<stage::TimeVerb>(random() % 9);
            if (op.verb == stage::TimeVerb::kReverse && was_endless) continue;
            // After a speed, a frame of the clip is shorter than one of the stage, so the last frame is shown less
            // long.
            const bool sped = std::any_of(map.begin(), map.end(), [](const stage::TimeOperator& before) {
                return before.verb == stage::TimeVerb::kSpeed && before.factor != 1;
            });
            if (sped && op.verb != stage::TimeVerb::kOffset && op.verb != stage::TimeVerb::kFreeze &&
                op.verb != stage::TimeVerb::kSpeed)
                break;
            cut(clip, op, random);
            was_endless = (was_endless || clip.endless) && op.verb != stage::TimeVerb::kClip;
            map.push_back(op);
        }
        const stage::Timeline made = stage::timeline_of(map, kFrames, kFps, "f", "p");
        for (size_t i = 0; i < 40; ++i, ++compared)
            ASSERT_EQ(stage::frame_at(made, static_cast<double>(i) / kFps), clip.at(i))
                << stage::text_of(map) << " at frame " << i;
    }
    EXPECT_GT(compared, 100000);
}

TEST(TimeMap, BothFormsComeBack) {
    const std::string text =
        "offset:-3f,speed:0.25,pause:1s:0.5s,freeze:2f,clip:0s:2s,reverse,jump:1s:3f,loop,loop:0s:2s,ping-pong,ping-"
        "pong:1f:9f,hold";
    const stage::TimeMap map = stage::parse_time_map(text, "f", "p");
    EXPECT_EQ(map.size(), 12u);
    EXPECT_EQ(stage::text_of(map), text);
    EXPECT_EQ(stage::time_map_of(stage::json_of(map), "f", "p"), map);
    EXPECT_EQ(stage::json_of(map)[7].dump(), R"({"operator":"loop"})");
    EXPECT_EQ(stage::json_of(map)[8].dump(), R"({"operator":"loop","from":"0s","to":"2s"})");
    EXPECT_EQ(stage::text_of(stage::parse_time_map("loop:0:2s,speed:0.5,offset:3f", "f", "p")),
              "loop:0s:2s,speed:0.5,offset:3f");
    EXPECT_TRUE(stage::parse_time_map("", "f", "p").empty());
}

TEST(TimeMap, WrongOnesNameTheMend) {
    const auto refused = [](const std::string& text, std::initializer_list<std::string> parts) {
        expect_input_error([&] { timeline(text); }, parts);
    };
    refused("lop", {"lop", "choose from", "ping-pong"});
    refused("offset:3", {"3", "1.5s"});
    refused("offset:nans", {"nan"});
    refused("offset:1e300s", {"1e300s"});
    refused("offset", {"offset", ":3f"});
    refused("pause:1s", {"pause", "1s:2s"});
    refused("reverse:1s", {"reverse"});
    refused("speed:0", {"0.001", "freeze"});
    refused("speed:-1", {"reverse"});
    refused("speed:inf", {"speed"});
    refused("freeze:-1s", {"before"});
    refused("clip:2s:1s", {"empty part"});
    refused("loop:1f:1f", {"empty part"});
    refused("loop,reverse", {"endless", "before the loop"});
    refused("loop,loop", {"endless"});
    refused("loop,,loop", {"operator"});
    std::string many = "reverse";
    for (int i = 0; i < 64; ++i) many += ",reverse";
    refused(many, {"64"});
    using nlohmann::ordered_json;
    const auto json_refused = [](const char* text, std::initializer_list<std::string> parts) {
        expect_input_error([&] { stage::time_map_of(ordered_json::parse(text), "my.gltf", "/time"); }, parts);
    };
    json_refused("{}", {"my.gltf", "/time", "list"});
    json_refused("[1]", {"/time/0", "object"});
    json_refused("[{}]", {"/time/0", "operator"});
    json_refused(R"([{"operator":1}])", {"/time/0/operator", "string"});
    json_refused(R"([{"operator":"offset","by":3}])", {"/time/0/by", "string"});
    json_refused(R"([{"operator":"speed","factor":"2"}])", {"/time/0/factor"});
    json_refused(R"([{"operator":"loop","from":"1s"}])", {"/time/0", "to"});
}

}  // namespace
}  // namespace neuvv
