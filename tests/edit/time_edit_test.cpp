#include "edit/time_edit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/input_error.h"

namespace neuvv {
namespace {

constexpr edit::ClipRate kClip{40, 25};

stage::TimeMap time_map(const std::string& text) {
    return stage::parse_time_map(text, "test", "");
}
stage::Timeline ready(const stage::TimeMap& map) {
    return stage::timeline_of(map, kClip.frames, kClip.fps, "test", "");
}
// The displayed frame of the clip at a time in frames of the stage.
double displayed(const stage::TimeMap& map, double t) {
    return stage::frame_at(ready(map), t / kClip.fps);
}
double s(double frames) {
    return frames / kClip.fps;
}

const char* const kFinite[] = {"",
                               "offset:7f",
                               "offset:-7f",
                               "clip:5f:31f",
                               "clip:0.3s:1.1s,offset:0.5s",
                               "reverse",
                               "reverse,clip:4f:20f,offset:-3f",
                               "clip:4f:30f,reverse,speed:2,offset:4f",
                               "speed:0.5,clip:10f:50f",
                               "speed:2,reverse,speed:0.25",
                               "pause:10f:8f,speed:1.25",
                               "jump:10f:20f,reverse,offset:3f",
                               "jump:20f:5f",
                               "offset:9f,offset:-5f,speed:0.8",
                               "offset:-9f,offset:5f",
                               "offset:2f,clip:1f:30f,clip:3f:20f,offset:1f",
                               "ping-pong:3f:9f,clip:2f:45f,reverse",
                               "loop:0:8f,speed:0.5,clip:0:60f,offset:-11f",
                               "speed:0.5,hold,offset:6f",
                               "reverse,hold,clip:0:20f"};
const char* const kEndless[] = {"loop", "loop:3f:20f,offset:5f", "ping-pong,speed:0.5,offset:-9f",
                                "loop,offset:-4f,speed:2,offset:6f", "clip:2f:9f,reverse,loop,hold"};

std::vector<std::string> all() {
    std::vector<std::string> maps(std::begin(kFinite), std::end(kFinite));
    maps.insert(maps.end(), std::begin(kEndless), std::end(kEndless));
    return maps;
}

// Odd times, away from the starts of loops.
std::vector<double> times_between(double first, double last, double step = 0.37) {
    std::vector<double> times;
    for (double t = first + 0.0123; t < last; t += step) times.push_back(t);
    return times;
}

// How long the bar's last frame is displayed, in frames.
double last_frame(const stage::TimeMap& map) {
    double frame = 1;
    for (const stage::TimeOperator& op : map)
        if (op.verb == stage::TimeVerb::kSpeed) frame /= op.factor;
    return frame;
}

TEST(TimeEdit, BarsBeginAndEndWhereMapsDo) {
    const auto bar = [](const char* text) {
        const edit::TimeBar found = edit::bar_of(time_map(text), kClip);
        return std::pair(found.start_s * kClip.fps, found.end_s * kClip.fps);
    };
    EXPECT_EQ(bar(""), std::pair(0.0, 40.0));
    EXPECT_EQ(bar("offset:5f"), std::pair(5.0, 45.0));
    EXPECT_EQ(bar("clip:5f:25f,speed:2,offset:-5f"), std::pair(-5.0, 5.0));
    EXPECT_EQ(bar("loop,offset:5f"), std::pair(5.0, double{INFINITY}));
    for (const std::string& text : all()) {
        const edit::TimeBar found = edit::bar_of(time_map(text), kClip);
        const double length = stage::length_s(ready(time_map(text)));
        EXPECT_EQ(std::isfinite(found.end_s), std::isfinite(length)) << text;
        if (std::isfinite(length)) {
            EXPECT_NEAR(found.end_s, length, 1e-9) << text;
        }
    }
}

TEST(TimeEdit, MovedIsTheSameAtAnotherTime) {
    for (const std::string& text : all())
        for (const double by : {3.0, -5.0, 12.5, 0.7, -30.0}) {
            const stage::TimeMap map = time_map(text), after = edit::moved(map, kClip, s(by));
            for (const double t : times_between(std::max(0.0, by), 90))
                ASSERT_NEAR(displayed(after, t), displayed(map, t - by), 1e-4) << text << " by " << by << " at " << t;
            const stage::TimeMap back = edit::moved(after, kClip, s(-by));
            for (const double t : times_between(0, 90))
                ASSERT_NEAR(displayed(back, t), displayed(map, t), 1e-4)
                    << text << " by " << by << " and back at " << t;
        }
    EXPECT_EQ(stage::text_of(edit::moved(time_map("offset:1s"), kClip, 0.5)), "offset:1.5s");
    EXPECT_EQ(stage::text_of(edit::moved(time_map("offset:1s"), kClip, 1)), "offset:50f") << "whole frames as such";
    EXPECT_EQ(stage::text_of(edit::moved(time_map("loop,offset:1s"), kClip, -1)), "loop");
    EXPECT_EQ(stage::text_of(edit::moved(time_map("offset:1s,offset:2s"), kClip, 0)), "offset:75f");
}

TEST(TimeEdit, ATrimmedStartLeavesTheRest) {
    for (const std::string& text : all()) {
        const stage::TimeMap map = time_map(text);
        const edit::TimeBar bar = edit::bar_of(map, kClip);
        const double start = bar.start_s * kClip.fps, end = std::min(60.0, bar.end_s * kClip.fps);
        for (const double part : {0.2, 0.55, 0.8}) {
            const double at = start + part * (end - last_frame(map) - start);
            const stage::TimeMap after = edit::trimmed_start(map, kClip, s(at));
            if (std::isfinite(bar.end_s)) {
                EXPECT_NEAR(edit::bar_of(after, kClip).end_s, bar.end_s, 1e-6) << text;
            }
            for (const double t : times_between(std::max(at, 0.0), 90))
                ASSERT_NEAR(displayed(after, t), displayed(map, t), 1e-4) << text << " from " << at << " at " << t;
            for (const double t : times_between(0, at))
                ASSERT_NEAR(displayed(after, t), displayed(map, at), 1e-4) << text << " before " << at << " at " << t;
        }
    }
}

TEST(TimeEdit, ATrimmedEndLeavesTheRest) {
    for (const std::string& text : all()) {
        const stage::TimeMap map = time_map(text);
        const edit::TimeBar bar = edit::bar_of(map, kClip);
        const double start = bar.start_s * kClip.fps, end = std::min(60.0, bar.end_s * kClip.fps);
        for (const double part : {0.3, 0.55, 0.9}) {
            const double frame = last_frame(map), at = start + frame + part * (end - start - frame);
            const stage::TimeMap after = edit::trimmed_end(map, kClip, s(at));
            EXPECT_NEAR(edit::bar_of(after, kClip).end_s, s(at), 1e-6) << text;
            for (const double t : times_between(0, std::max(0.0, at - frame)))
                ASSERT_NEAR(displayed(after, t), displayed(map, t), 1e-4) << text << " to " << at << " at " << t;
            for (const double t : times_between(std::max(0.0, at - frame), 90))
                ASSERT_NEAR(displayed(after, t), displayed(map, std::max(0.0, at - frame)), 1e-4)
                    << text << " after " << at << " at " << t;
        }
    }
}

TEST(TimeEdit, WhatWasTrimmedCanBePulledOut) {
    for (const std::string& text : all()) {
        const stage::TimeMap map = time_map(text);
        const edit::TimeBar bar = edit::bar_of(map, kClip);
        const double end = std::min(bar.end_s, bar.start_s + 2);
        stage::TimeMap cut = edit::trimmed_start(map, kClip, bar.start_s + 0.4 * (end - bar.start_s));
        if (std::isfinite(bar.end_s)) cut = edit::trimmed_end(cut, kClip, bar.start_s + 0.6 * (end - bar.start_s));
        cut = edit::trimmed_start(cut, kClip, bar.start_s);
        if (std::isfinite(bar.end_s)) cut = edit::trimmed_end(cut, kClip, bar.end_s);
        for (const double t : times_between(0, 90))
            ASSERT_NEAR(displayed(cut, t), displayed(map, t), 1e-4) << text << " at " << t;
    }
    EXPECT_EQ(edit::trimmed_end(time_map("offset:3f"), kClip, 100), time_map("offset:3f")) << "there is no more";
    EXPECT_EQ(edit::trimmed_start(time_map("offset:3f"), kClip, -100), time_map("offset:3f"));
    EXPECT_EQ(edit::trimmed_start(time_map("offset:3f"), kClip, 100), time_map("clip:39f:40f,offset:42f"))
        << "a frame is left";
    EXPECT_EQ(edit::trimmed_end(time_map("offset:3f"), kClip, -100), time_map("clip:0f:1f,offset:3f"));
}

TEST(TimeEdit, ReversedPlaysBackwardsWhereItStands) {
    for (const std::string text : kFinite) {
        const stage::TimeMap map = time_map(text), after = edit::reversed(map, kClip);
        const edit::TimeBar bar = edit::bar_of(map, kClip), turned = edit::bar_of(after, kClip);
        EXPECT_NEAR(bar.start_s, turned.start_s, 1e-9) << text;
        EXPECT_NEAR(bar.end_s, turned.end_s, 1e-9) << text;
        const double start = bar.start_s * kClip.fps, last = bar.end_s * kClip.fps - last_frame(map);
        const bool has_hold = text.find("hold") != std::string::npos;  // rounds down forwards and backwards
        for (const double t : times_between(std::max(0.0, start), last))
            if (start + last - t > 0) {
                ASSERT_NEAR(displayed(after, t), displayed(map, start + last - t), has_hold ? 1.0 : 1e-4)
                    << text << " at " << t;
            }
        const stage::TimeMap back = edit::reversed(after, kClip);
        for (const double t : times_between(0, 90))
            ASSERT_NEAR(displayed(back, t), displayed(map, t), 1e-4) << text << " at " << t;
    }
    EXPECT_EQ(stage::text_of(edit::reversed(time_map("reverse"), kClip)), "");
    for (const char* text : kEndless)
        EXPECT_NO_THROW(edit::reversed(edit::trimmed_end(time_map(text), kClip, 3), kClip)) << text;
}

TEST(TimeEdit, WhatIsEndlessPlaysItsRoundsBackwards) {
    struct {
        const char* text;
        double first, step, round;  // frame at 0, its change per frame of the stage, for how many frames
    } const cases[] = {{"loop", 39, -1, 39},
                       {"loop:5f:15f", 14, -1, 9},
                       {"speed:2,loop:5f:15f", 29, -2, 9},
                       {"loop:5f:15f,speed:2", 14, -2, 4},
                       {"reverse,loop", 0, 1, 39},
                       {"ping-pong:3f:9f", 8, -1, 5}};
    for (const auto& one : cases) {
        const stage::TimeMap after = edit::reversed(time_map(one.text), kClip);
        for (double t = 0; t < one.round; t += 0.25)
            ASSERT_NEAR(displayed(after, t), one.first + one.step * t, 1e-6) << one.text << " at " << t;
    }
    for (const std::string text : kEndless) {
        const stage::TimeMap map = time_map(text), back = edit::reversed(edit::reversed(map, kClip), kClip);
        for (const double t : times_between(0, 120))
            ASSERT_NEAR(displayed(back, t), displayed(map, t), 1e-6) << text << " at " << t;
        EXPECT_LE(back.size(), map.size() + 1) << "it does not grow from time to time";
    }
    stage::TimeMap full(stage::kMaxTimeOperators, time_map("jump:1f:2f")[0]);
    full.back() = time_map("loop")[0];
    expect_input_error([&] { edit::reversed(full, kClip); }, {"operators"});
}

TEST(TimeEdit, SpedPlaysFasterFromWhereItBegins) {
    for (const std::string& text : all())
        for (const double factor : {2.0, 0.5, 1.3}) {
            const stage::TimeMap map = time_map(text), after = edit::sped(map, kClip, factor);
            const double start = edit::bar_of(map, kClip).start_s * kClip.fps;
            for (const double t : times_between(std::max(0.0, start), 90)) {
                const double source = start + factor * (t - start);
                if (source >= 0) {
                    ASSERT_NEAR(displayed(after, t), displayed(map, source), 1e-4)
                        << text << " x" << factor << " at " << t;
                }
            }
            for (const double t : times_between(0, start))
                ASSERT_NEAR(displayed(after, t), displayed(map, 0), 1e-4) << text << " x" << factor << " at " << t;
        }
    EXPECT_EQ(stage::text_of(edit::sped(time_map("speed:0.5,offset:3f"), kClip, 2)), "offset:3f");
    EXPECT_EQ(stage::text_of(edit::sped(time_map("hold,speed:0.5"), kClip, 3)), "speed:1.5,hold");
    for (const double factor : {0.0, -1.0, 1e9, double{NAN}})
        expect_input_error([&] { edit::sped(time_map(""), kClip, factor); }, {"speed"});
}

TEST(TimeEdit, StaggeredAsCopiesAre) {
    EXPECT_EQ(stage::text_of(edit::staggered(time_map(""), kClip, {3, true})), "offset:3f");
    EXPECT_EQ(stage::text_of(edit::staggered(time_map("offset:2f"), kClip, {3, true})), "offset:5f");
    EXPECT_EQ(stage::text_of(edit::staggered(time_map("loop:0:10f"), kClip, {3, true})), "loop:0s:10f,offset:-7f");
    EXPECT_EQ(stage::text_of(edit::staggered(time_map("loop:0:10f,offset:3f"), kClip, {3, true})),
              "loop:0s:10f,offset:6f")
        << "it waits before it begins";
    for (const char* text : {"loop", "ping-pong,speed:0.5", "loop:3f:20f,offset:-4f"}) {
        const stage::TimeMap map = time_map(text), later = edit::staggered(map, kClip, {0.2, false});
        for (const double t : times_between(40, 120))
            ASSERT_NEAR(displayed(later, t), displayed(map, t - 5), 1e-4) << text;
    }
}

// After hours of dragging a map still has only the few operators of a bar.
TEST(TimeEdit, DragsDoNotPileUp) {
    std::mt19937 random(5);
    const auto below = [&](double limit) { return limit * std::generate_canonical<double, 32>(random); };
    for (const std::string& text : all()) {
        stage::TimeMap map = time_map(text);
        const size_t max_size = map.size() + 5;
        for (int i = 0; i < 300; ++i) {
            const edit::TimeBar bar = edit::bar_of(map, kClip);
            switch (random() % 5) {
                case 0:
                    map = edit::moved(map, kClip, below(4) - 2);
                    break;
                case 1:
                    map = edit::trimmed_start(map, kClip, bar.start_s + below(2) - 1);
                    break;
                case 2:
                    map = edit::trimmed_end(map, kClip, std::min(bar.end_s, bar.start_s + 9) + below(2) - 1);
                    break;
                case 3:
                    map = edit::sped(map, kClip, bar.end_s - bar.start_s > 5 ? 1.25 : 0.8);
                    break;
                default:
                    map = edit::reversed(map, kClip);
            }
            ASSERT_LE(map.size(), max_size) << text << " became " << stage::text_of(map);
            ASSERT_EQ(stage::parse_time_map(stage::text_of(map), "test", ""), map);
        }
    }
}

TEST(TimeEdit, NumbersWithoutMeaningAreRefused) {
    for (const double bad : {double{NAN}, double{INFINITY}, -double{INFINITY}, 1e300})
        for (const char* text : {"", "loop", "clip:3f:9f,reverse,offset:2f"}) {
            expect_input_error([&] { edit::moved(time_map(text), kClip, bad); }, {"time map"});
            expect_input_error([&] { edit::trimmed_start(time_map(text), kClip, bad); }, {"time map"});
            expect_input_error([&] { edit::trimmed_end(time_map(text), kClip, bad); }, {"time map"});
        }
    expect_input_error([&] { edit::moved(time_map("loop,reverse"), kClip, 1); }, {"endless"});
    stage::TimeMap full(stage::kMaxTimeOperators, time_map("jump:1f:2f")[0]);
    expect_input_error([&] { edit::moved(full, kClip, 1); }, {"operators"});
}

}  // namespace
}  // namespace neuvv
