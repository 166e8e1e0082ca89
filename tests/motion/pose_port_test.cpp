// Sources of poses that listen at a port: real packets, on a clock of the test's own.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "base/udp_socket.h"
#include "motion/live/line_source.h"
#include "motion/live/pose_source.h"
#include "motion/senders.h"
#include "motion/sent_pose.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv::pose_source_test {
namespace {

// A T-pose in Unity's space, whose hips are at x.
std::vector<test::VmcPart> t_pose(float x) {
    const auto bone = [](const std::string& name, float px, float py, float pz) {
        return test::VmcPart{"/VMC/Ext/Bone/Pos", name, {px, py, pz, 0, 0, 0, 1}};
    };
    std::vector<test::VmcPart> parts = {bone("Hips", x, 1, 0), bone("Spine", 0, 0.3f, 0), bone("Head", 0, 0.3f, 0)};
    for (const std::string side : {"Left", "Right"}) {
        const float out = side == "Left" ? -1 : 1;
        for (const auto& [name, px, py] : {std::tuple{"UpperArm", 0.15f, 0.2f},
                                           {"LowerArm", 0.3f, 0.f},
                                           {"Hand", 0.25f, 0.f},
                                           {"UpperLeg", 0.1f, 0.f},
                                           {"LowerLeg", 0.f, -0.45f},
                                           {"Foot", 0.f, -0.45f}})
            parts.push_back(bone(side + name, out * px, py, 0));
    }
    return parts;
}

struct PoseSourceOnPort : testing::Test {
    std::unique_ptr<PoseSource> json = open_pose_source("udp:0"), vmc = open_pose_source("vmc:0");
    test::UdpTransmitter first, second{2};

    void send(double time_s, double x) const { first.send(line_of(time_s, x), port_of(*json)); }
};

TEST_F(PoseSourceOnPort, LinesOfJsonArrive) {
    EXPECT_EQ(json->name(), fmt::format("JSON on 127.0.0.1:{}", port_of(*json)));
    EXPECT_FALSE(json->newest(10));
    EXPECT_FALSE(json->state().stopped) << "nothing has begun";
    send(500, 1);
    const auto pose = json->newest(10.5);
    EXPECT_EQ(nose_of(pose), 1);
    EXPECT_NEAR(pose->time_s, 10.5, 1e-9) << "on the caller's clock";
    EXPECT_FALSE(json->newest(10.6));
    for (const double x : {2., 3., 4.}) send(500 + x, x);
    EXPECT_EQ(nose_of(json->newest(10.7)), 4) << "the newest";
    EXPECT_EQ(json->state().poses, 4u);
    EXPECT_EQ(json->state().left_out, 0u);
}

TEST_F(PoseSourceOnPort, TimesKeepTheSendersPace) {
    // Packets wait up to 30 ms on their way, the first one 20 ms; poses are 20 ms apart nevertheless.
    const double waits_s[] = {0.02, 0.03, 0, 0.01, 0.03, 0.015};
    std::vector<double> times_s;
    for (int i = 0; i < 6; ++i) {
        send(100 + 0.02 * i, i);
        const double now_s = 7 + 0.02 * i + waits_s[i];
        times_s.push_back(json->newest(now_s)->time_s);
        EXPECT_LE(times_s.back(), now_s + 1e-9);
    }
    for (size_t i = 3; i < 6; ++i) EXPECT_NEAR(times_s[i] - times_s[i - 1], 0.02, 1e-9);
    EXPECT_NEAR(times_s[2], 7.04, 1e-9) << "it did not wait";
    // A clock that was set forwards, and one that runs far too slowly.
    send(900, 6);
    EXPECT_NEAR(json->newest(7.2)->time_s, 7.2, 1e-9);
    send(900.01, 7);
    EXPECT_NEAR(json->newest(7.7)->time_s, 7.7, 1e-9);
}

TEST_F(PoseSourceOnPort, ReorderedPosesAreLeftOut) {
    for (const double time_s : {1.0, 1.2, 1.1, 1.2}) send(time_s, time_s);
    EXPECT_EQ(nose_of(json->newest(5)), 1.2);
    EXPECT_EQ(json->state().poses, 2u);
    EXPECT_EQ(json->state().left_out, 2u);
    send(1.15, 9);
    EXPECT_FALSE(json->newest(5.1)) << "a call later, too";
    EXPECT_NE(json->state().first_error.find("time"), std::string::npos);
    // A program that begins anew begins its time anew.
    send(0, 0.5);
    EXPECT_EQ(nose_of(json->newest(6.5)), 0.5);
}

TEST_F(PoseSourceOnPort, StopsAndGoesOn) {
    send(1, 1);
    json->newest(0);
    json->newest(0.9);
    EXPECT_FALSE(json->state().stopped);
    json->newest(1.1);
    EXPECT_TRUE(json->state().stopped);
    send(2.2, 2);
    EXPECT_EQ(nose_of(json->newest(1.2)), 2);
    EXPECT_FALSE(json->state().stopped);
}

TEST_F(PoseSourceOnPort, ASecondSenderDoesNoHarm) {
    const auto intrude = [&](double time_s) { second.send(line_of(time_s, -1), port_of(*json)); };
    send(1, 1);
    intrude(100);
    EXPECT_EQ(nose_of(json->newest(0)), 1);
    EXPECT_EQ(json->state().left_out, 1u);
    EXPECT_NE(json->state().first_error.find("second sender"), std::string::npos);
    intrude(101);
    EXPECT_FALSE(json->newest(1.9)) << "not yet silent for 2 s";
    send(3, 3);
    EXPECT_EQ(nose_of(json->newest(1.95)), 3);
    // The caller was away; both went on sending.
    intrude(102);
    send(60, 4);
    EXPECT_EQ(nose_of(json->newest(60)), 4);
    // The first sender falls silent.
    json->newest(62.1);
    intrude(0.5);
    EXPECT_EQ(nose_of(json->newest(62.2)), -1);
    send(70, 5);
    EXPECT_FALSE(json->newest(62.3));
}

TEST_F(PoseSourceOnPort, MalformedLinesAreLeftOut) {
    const std::string sound = line_of(1, 1);
    size_t sent = 0;
    const auto refuse = [&](const std::string& bytes) {
        first.send(bytes, port_of(*json));
        EXPECT_FALSE(json->newest(0)) << bytes.substr(0, 100);
        EXPECT_EQ(json->state().left_out, ++sent);
    };
    for (size_t size = 0; size < sound.size(); ++size) refuse(sound.substr(0, size));
    refuse(R"({"time": 1, "joints": {"nose": [0, 1e999, 0]}})");
    refuse(R"({"time": NaN, "joints": {"nose": [0, 1, 0]}})");
    refuse(R"({"time": 1, "joints": {"nose": [0, null, 0]}})");
    refuse(R"({"time": 1, "joints": {"tail": [0, 1, 0]}})");
    refuse(std::string(16000, '['));
    refuse(sound + std::string(UdpSocket::kLargestPacket, ' '));
    // None of them made its sender the source's.
    second.send(sound, port_of(*json));
    EXPECT_EQ(nose_of(json->newest(0)), 1);
    EXPECT_EQ(json->state().first_error.find('\n'), std::string::npos);
}

TEST_F(PoseSourceOnPort, VmcArrivesFromASocket) {
    first.send(test::vmc_bundle(t_pose(0.25f)), port_of(*vmc));
    const auto pose = vmc->newest(3);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->time_s, 3);
    EXPECT_NEAR(at(pose->pose, Joint::kPelvis).position.x, -0.25, 1e-6);
    EXPECT_NEAR(at(pose->pose, Joint::kLeftWrist).position.x, -0.25 + 0.7, 1e-6);
    // Other messages are neither poses nor faults; damaged ones are faults.
    first.send(test::vmc_packet({"/VMC/Ext/Blend/Val", "Joy", {1}}), port_of(*vmc));
    EXPECT_FALSE(vmc->newest(3.1));
    EXPECT_EQ(vmc->state().left_out, 0u);
    first.send("/VMC", port_of(*vmc));
    EXPECT_FALSE(vmc->newest(3.2));
    EXPECT_EQ(vmc->state().left_out, 1u);
    EXPECT_EQ(vmc->state().poses, 1u);
    // Another sender begins with a body of its own.
    vmc->newest(6);
    const std::vector<test::VmcPart> parts = t_pose(1);
    second.send(test::vmc_packet(parts[0]), port_of(*vmc));
    EXPECT_FALSE(vmc->newest(6.1)) << "hips alone are no body";
    second.send(test::vmc_bundle(parts), port_of(*vmc));
    EXPECT_TRUE(vmc->newest(6.2));
}

// One address is one sender: programs take another port for each packet, or when they begin anew.
TEST_F(PoseSourceOnPort, AnotherPortIsNoOtherSender) {
    const test::UdpTransmitter again;
    send(1, 1);
    EXPECT_EQ(nose_of(json->newest(0)), 1);
    again.send(line_of(2, 2), port_of(*json));
    EXPECT_EQ(nose_of(json->newest(0.1)), 2);
    EXPECT_EQ(json->state().left_out, 0u);
    for (int i = 0; i < 4; ++i) {
        (i % 2 ? first : again).send(test::vmc_bundle(t_pose(static_cast<float>(i))), port_of(*vmc));
        EXPECT_TRUE(vmc->newest(i));
    }
    EXPECT_EQ(vmc->state().left_out, 0u);
}

// Two programs on one machine, which both send again and again: the bodies are never mixed.
TEST_F(PoseSourceOnPort, OfTwoBodiesOfOneMachineTheFirstCounts) {
    const test::UdpTransmitter near;
    std::vector<test::VmcPart> other = t_pose(9);
    other.push_back({"/VMC/Ext/Bone/Pos", "UpperChest", {5, 5, 5, 0, 0, 0, 1}});  // a bone that the first one lacks
    const std::vector<test::VmcPart> parts = t_pose(1);
    for (int i = 0; i < 20; ++i) {
        SCOPED_TRACE(i);
        // Bone by bone, as some programs send, from the second frame on in turns.
        for (size_t p = 0; p < other.size(); ++p) {
            if (p < parts.size()) first.send(test::vmc_packet(parts[p]), port_of(*vmc));
            if (i > 0) near.send(test::vmc_packet(other[p]), port_of(*vmc));
        }
        const auto pose = vmc->newest(0.03 * i);
        ASSERT_TRUE(pose);
        EXPECT_NEAR(at(pose->pose, Joint::kPelvis).position.x, -1, 1e-6);
        EXPECT_NEAR(at(pose->pose, Joint::kLeftWrist).position.x, -1 + 0.7, 1e-6);
        send(i, 1);
        near.send(line_of(i + 0.5, 2), port_of(*json));
        EXPECT_TRUE(i == 0 || nose_of(json->newest(0.03 * i)) == 1);
    }
    EXPECT_EQ(vmc->state().left_out, 19 * other.size());
    for (const PoseSource* source : {vmc.get(), json.get()})
        EXPECT_NE(source->state().first_error.find("sends another body than port"), std::string::npos)
            << source->state().first_error;
    // The first program has ended.
    near.send(test::vmc_bundle(other), port_of(*vmc));
    vmc->newest(1.5);
    near.send(test::vmc_bundle(other), port_of(*vmc));
    const auto pose = vmc->newest(1.6);
    ASSERT_TRUE(pose);
    EXPECT_NEAR(at(pose->pose, Joint::kPelvis).position.x, -9, 1e-6);
    // And the second one, too, of which nothing is left: hips alone are no body.
    near.send(test::vmc_bundle(other), port_of(*vmc));
    vmc->newest(1.7);
    vmc->newest(2.5);
    first.send(test::vmc_bundle({parts[0]}), port_of(*vmc));
    EXPECT_FALSE(vmc->newest(2.6));
}

// A program that takes another port for each packet, some of them again.
TEST_F(PoseSourceOnPort, AProgramMayTakePortsAgain) {
    const std::array<test::UdpTransmitter, 6> ports;
    for (int i = 0; i < 60; ++i) {
        const test::UdpTransmitter& port = ports[static_cast<size_t>(i < 6 ? i : (i * i) % 6)];
        port.send(test::vmc_bundle(t_pose(static_cast<float>(i))), port_of(*vmc));
        const auto pose = vmc->newest(0.03 * i);
        ASSERT_TRUE(pose) << i;
        EXPECT_NEAR(at(pose->pose, Joint::kPelvis).position.x, -i, 1e-5);
    }
    EXPECT_EQ(vmc->state().left_out, 0u);
}

TEST_F(PoseSourceOnPort, OfTwoPersonsInLinesTheFirstCounts) {
    const auto line = [](double time_s, double x, const std::string& person) {
        std::string text = line_of(time_s, x);
        return text.insert(1, "\"person\":" + person + ",");
    };
    const TemporaryFolder folder;
    std::string lines;
    for (int i = 0; i < 10; ++i)
        for (const char* person : {"\"anna\"", "7"}) {
            const std::string one = line(0.1 * i, *person == '7' ? 2 : 1, person);
            first.send(one, port_of(*json));
            lines += one + "\n";
            EXPECT_EQ(nose_of(json->newest(0.1 * i)) == 1, *person != '7');
        }
    const std::string file = (folder.path / "two.jsonl").string();
    write_text(file, lines);
    const auto recorded = open_pose_source(file);
    int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const auto piped = motion::read_lines_of_poses(descriptor, "pipe");
    for (int i = 0; i < 10; ++i) EXPECT_EQ(nose_of(recorded->newest(0.1 * i + 1e-6)), 1);
    EXPECT_EQ(nose_of(piped->newest(1)), 1);
    close(descriptor);
    for (const PoseSource* source : {json.get(), recorded.get(), piped.get()}) {
        EXPECT_EQ(source->state().left_out, 10u);
        EXPECT_NE(source->state().first_error.find("person: is \"7\", and \"anna\", who came first, is followed"),
                  std::string::npos)
            << source->state().first_error;
    }
    // Who came first has gone.
    first.send(line(3.5, 2, "7"), port_of(*json));
    EXPECT_EQ(nose_of(json->newest(3.5)), 2);
}

// A tracker of faces, on the same machine or another one, and a program that sends the body.
TEST_F(PoseSourceOnPort, TheSenderWithABodyCounts) {
    const test::UdpTransmitter near_face, far_face{3};
    const auto status = [](int tracked) {
        return test::vmc_bundle({{"/VMC/Ext/OK", "", {1, 3, 0, static_cast<float>(tracked)}},
                                 {"/VMC/Ext/Blend/Val", "A", {0.3f}},
                                 {"/VMC/Ext/Bone/Pos", "LeftEye", {0, 0, 0, 0, 0, 0, 1}}});
    };
    // What trackers of faces may send of bones, twice, so that more is not expected.
    const std::vector<test::VmcPart> parts = t_pose(0);
    const std::string head = test::vmc_bundle({parts[1], parts[2]});
    for (int i = 0; i < 20; ++i) {
        SCOPED_TRACE(i);
        near_face.send(status(0), port_of(*vmc));
        far_face.send(status(0), port_of(*vmc));
        if (i < 10) far_face.send(head, port_of(*vmc));
        first.send(test::vmc_bundle(t_pose(0.1f * static_cast<float>(i))), port_of(*vmc));
        const auto pose = vmc->newest(0.03 * i);
        ASSERT_TRUE(pose);
        EXPECT_NEAR(at(pose->pose, Joint::kPelvis).position.x, -0.1 * i, 1e-6);
    }
    EXPECT_EQ(vmc->state().poses, 20u);
    // The body's own status counts.
    first.send(status(0), port_of(*vmc));
    first.send(test::vmc_bundle(t_pose(0)), port_of(*vmc));
    EXPECT_FALSE(vmc->newest(1));
    // A sender of a face alone is told what is missing, once a body might have come.
    const auto faces = open_pose_source("vmc:0");
    for (int i = 0; i < 3; ++i) {
        far_face.send(head, port_of(*faces));
        EXPECT_FALSE(faces->newest(0.6 * i));
        EXPECT_EQ(faces->state().first_error.empty(), i < 2);
    }
    EXPECT_NE(faces->state().first_error.find("left foot; let the program that sends track the whole body"),
              std::string::npos)
        << faces->state().first_error;
}

TEST_F(PoseSourceOnPort, AdviceFitsTheProtocol) {
    EXPECT_NE(vmc->advice().find("VMC protocol to 127.0.0.1:"), std::string::npos) << vmc->advice();
    EXPECT_NE(json->advice().find("JSON in each packet"), std::string::npos) << json->advice();
}

// More packets than can wait: the call ends, and the poses stay those of the source's sender, in order.
TEST_F(PoseSourceOnPort, AFloodDoesNotStallTheCaller) {
    std::atomic<bool> flooding = true;
    const uint16_t port = port_of(*json);
    std::thread flood([&] {
        for (double time_s = 1; flooding; time_s += 1e-3) first.send(line_of(time_s, time_s), port);
    });
    double last = 0;
    uint64_t calls = 0, before = 0;
    for (double now_s = 0; json->state().poses < 20000; now_s += 1e-3, ++calls) {
        const auto pose = json->newest(now_s);
        const motion::PoseSourceState state = json->state();
        EXPECT_LE(state.poses + state.left_out - before, UdpSocket::kMostWaiting);
        before = state.poses + state.left_out;
        if (!pose) continue;
        EXPECT_GT(nose_of(pose), last);
        last = nose_of(pose);
    }
    flooding = false;
    flood.join();
    // What waits at the beginning of a call is read to its end, so that its pose is not older than that.
    json->newest(1e6);
    for (int i = 0; i < 3000; ++i) send(1e6 + i, i);
    const double newest = nose_of(json->newest(1e6 + 1));
    EXPECT_GT(newest, 50) << "the rest found the socket's buffer full";
    EXPECT_FALSE(json->newest(1e6 + 1.1)) << "nothing was left waiting";
}

// An hour at 60 Hz, and its memory. The sanitizer's allocator counts nothing, so a minute is enough for it.
TEST_F(PoseSourceOnPort, TakesNoMoreMemoryTheLongerItRuns) {
#ifdef __SANITIZE_ADDRESS__
    constexpr int kPoses = 60 * 60;
#else
    constexpr int kPoses = 60 * 3600;
#endif
    constexpr int kSettled = 600;
    const std::string bundle = test::vmc_bundle(t_pose(0));
    struct mallinfo2 settled {};
    for (int i = 0; i < kPoses; ++i) {
        const double now_s = i / 60.0;
        first.send(bundle, port_of(*vmc));
        if (i % 7 == 0) second.send(bundle, port_of(*vmc));
        if (i % 11 == 0) first.send("malformed", port_of(*vmc));
        ASSERT_TRUE(vmc->newest(now_s));
        if (i % 20 == 0) {
            send(now_s, i % 1000);
            ASSERT_TRUE(json->newest(now_s));
        }
        if (i == kSettled) settled = mallinfo2();
    }
    const struct mallinfo2 now = mallinfo2();
    EXPECT_EQ(vmc->state().poses, uint64_t{kPoses});
    EXPECT_GT(vmc->state().left_out, uint64_t{kPoses} / 5);
    EXPECT_LE(now.uordblks, settled.uordblks + 4096) << "bytes in use";
    EXPECT_LE(now.arena + now.hblkhd, settled.arena + settled.hblkhd + (1 << 18)) << "bytes taken from the system";
}

}  // namespace
}  // namespace neuvv::pose_source_test
