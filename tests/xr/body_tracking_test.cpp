// The wearer's body through the real loader, from the scripted runtime (tests/xr_runtime).
#include "xr/body_tracking.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <map>
#include <nlohmann/json.hpp>

#include "support/temporary_folder.h"
#include "xr/actions.h"

namespace neuvv::test {
namespace {

using motion::Joint;
using nlohmann::json;
using xr::BodySource;

constexpr int kFrames = 12, kFocused = 8;  // the session has the input focus by this frame

// A place of its own for each joint of the runtime.
glm::dvec3 place_of(int number) {
    return {0.1 * number - 4, 1 + 0.01 * number, -0.05 * number};
}

json joints_at_their_places(int from, int to, const char* flags = "tracked") {
    json joints = json::object();
    for (int i = from; i < to; ++i) {
        const glm::dvec3 at = place_of(i);
        joints[std::to_string(i)] = {{"at", {at.x, at.y, at.z}}, {"flags", flags}};
    }
    return joints;
}

struct Seen {
    BodySource source = BodySource::kThreePoints;
    std::vector<std::optional<motion::Pose>> poses;  // by frame
};

class BodyTracking : public testing::Test {
  protected:
    BodyTracking() : script{{"width", 32}, {"height", 32}, {"timeline", {{{"frame", 0}}}}, {"end_frame", kFrames}} {}

    json& key(int frame) {
        for (json& one : script["timeline"])
            if (one["frame"] == frame) return one;
        script["timeline"].push_back({{"frame", frame}});
        return script["timeline"].back();
    }
    void track(const std::vector<std::string>& bodies, json joints) {
        script["bodies"] = bodies;
        key(0)["body"]["joints"] = std::move(joints);
    }

    // Tracks the body in all frames of the script, and expects that the runtime had nothing to complain of.
    Seen run() {
        setenv("XR_RUNTIME_JSON", NEUVV_XR_RUNTIME, 1);
        write_text(folder.path / "script.json", script.dump());
        setenv("NEUVV_XR_SCRIPT", (folder.path / "script.json").c_str(), 1);
        setenv("NEUVV_XR_OUT", folder.path.c_str(), 1);
        Seen seen;
        {
            xr::Runtime runtime;
            const gpu::Device device("", gpu::Validation::kOff, runtime.device_extensions(), runtime.device_maker());
            xr::Session session(runtime, device);
            xr::Actions actions(session, false);
            const xr::BodyTracker body(session);
            seen.source = body.source();
            watch(session, actions, body, seen);
        }
        const json report = json::parse(read_text(folder.path / "report.json"), nullptr, false);
        EXPECT_EQ(report.value("violations", json()), json::array());
        EXPECT_EQ(report.value("warnings", json()), json::array());
        EXPECT_EQ(report.value("destroyed_cleanly", json()), true);
        return seen;
    }

    json script;
    TemporaryFolder folder;

  private:
    static void watch(xr::Session& session, xr::Actions& actions, const xr::BodyTracker& body, Seen& seen) {
        xr::SessionEvents events;
        for (auto status = session.poll(events); status != xr::SessionStatus::kEnded; status = session.poll(events)) {
            if (status != xr::SessionStatus::kRunning) continue;
            const xr::FrameTime time = session.wait_frame();
            session.begin_frame();
            const xr::HandInputs hands = actions.sample(time.display);
            xr::BodyPoints points;
            points.head = session.locate(session.head_space(), time.display);
            for (int hand = 0; hand < xr::kHands; ++hand) points.wrists[hand] = xr::wrist_of(hands[hand], {});
            points.trackers = actions.locate_trackers(time.display);
            seen.poses.push_back(body.locate(points, time.display));
            session.end_frame(time, XR_ENVIRONMENT_BLEND_MODE_OPAQUE, {});
        }
    }
};

void expect_joint(const motion::Pose& pose, Joint joint, glm::dvec3 position) {
    const motion::JointSample& found = motion::at(pose, joint);
    EXPECT_LT(glm::distance(found.position, position), 1e-4)
        << motion::info_of(joint).name << " at " << found.position.x << " " << found.position.y;
    EXPECT_GT(found.confidence, 0) << motion::info_of(joint).name;
}

void expect_unknown(const motion::Pose& pose, Joint joint) {
    EXPECT_EQ(motion::at(pose, joint).confidence, 0) << motion::info_of(joint).name;
    EXPECT_FALSE(motion::at(pose, joint).measured) << motion::info_of(joint).name;
}

const std::map<Joint, int> kMetaArms = {{Joint::kPelvis, 1},      {Joint::kRightShoulder, 15}, {Joint::kRightElbow, 16},
                                        {Joint::kRightWrist, 45}, {Joint::kLeftShoulder, 10},  {Joint::kLeftElbow, 11},
                                        {Joint::kLeftWrist, 19}};
const std::map<Joint, int> kMetaLegs = {{Joint::kRightHip, 77},    {Joint::kRightKnee, 78}, {Joint::kRightAnkle, 80},
                                        {Joint::kRightBigToe, 83}, {Joint::kLeftHip, 70},   {Joint::kLeftKnee, 71},
                                        {Joint::kLeftAnkle, 73},   {Joint::kLeftBigToe, 76}};

TEST_F(BodyTracking, MetasJointsAreInTheirPlaces) {
    track({"fb", "full_body"}, joints_at_their_places(0, 84));
    const Seen seen = run();
    EXPECT_EQ(seen.source, BodySource::kMetaFullBody);
    ASSERT_EQ(seen.poses.size(), size_t{kFrames} + 1);
    ASSERT_TRUE(seen.poses[3]);
    const motion::Pose& pose = *seen.poses[3];
    for (const auto& list : {kMetaArms, kMetaLegs})
        for (const auto& [joint, number] : list) {
            expect_joint(pose, joint, place_of(number));
            EXPECT_TRUE(motion::at(pose, joint).measured) << motion::info_of(joint).name;
        }
    expect_joint(pose, Joint::kNeck, (place_of(10) + place_of(15)) / 2.0);
    expect_joint(pose, Joint::kNose, {0, 1.56, -0.02});
    for (const Joint joint : {Joint::kRightHeel, Joint::kRightSmallToe, Joint::kLeftHeel, Joint::kLeftSmallToe})
        expect_unknown(pose, joint);
}

TEST_F(BodyTracking, GeneratedLegsAreNotMeasured) {
    json joints = joints_at_their_places(0, 70);
    joints.update(joints_at_their_places(70, 84, "valid"));
    track({"fb", "full_body"}, joints);
    key(0)["body"]["confidence"] = 0.5;
    const Seen seen = run();
    ASSERT_TRUE(seen.poses.at(3));
    for (const auto& [joint, number] : kMetaLegs) {
        expect_joint(*seen.poses[3], joint, place_of(number));
        EXPECT_FALSE(motion::at(*seen.poses[3], joint).measured) << motion::info_of(joint).name;
        EXPECT_EQ(motion::at(*seen.poses[3], joint).confidence, 0.25) << motion::info_of(joint).name;
    }
    for (const auto& [joint, number] : kMetaArms) {
        EXPECT_TRUE(motion::at(*seen.poses[3], joint).measured) << motion::info_of(joint).name;
        EXPECT_EQ(motion::at(*seen.poses[3], joint).confidence, 0.5) << motion::info_of(joint).name;
    }
}

TEST_F(BodyTracking, TheUpperBodyHasNoLegs) {
    track({"fb"}, joints_at_their_places(0, 84));
    const Seen seen = run();
    EXPECT_EQ(seen.source, BodySource::kMetaUpperBody);
    ASSERT_TRUE(seen.poses.at(3));
    for (const auto& [joint, number] : kMetaArms) expect_joint(*seen.poses[3], joint, place_of(number));
    for (const auto& [joint, number] : kMetaLegs) expect_unknown(*seen.poses[3], joint);
}

TEST_F(BodyTracking, PicosJointsAreInTheirPlaces) {
    track({"bd"}, joints_at_their_places(0, 24));
    const Seen seen = run();
    EXPECT_EQ(seen.source, BodySource::kBd);
    ASSERT_TRUE(seen.poses.at(3));
    const std::map<Joint, int> numbers = {
        {Joint::kRightShoulder, 17}, {Joint::kRightElbow, 19},  {Joint::kRightWrist, 21}, {Joint::kLeftShoulder, 16},
        {Joint::kLeftElbow, 18},     {Joint::kLeftWrist, 20},   {Joint::kRightHip, 2},    {Joint::kRightKnee, 5},
        {Joint::kRightAnkle, 8},     {Joint::kRightBigToe, 11}, {Joint::kLeftHip, 1},     {Joint::kLeftKnee, 4},
        {Joint::kLeftAnkle, 7},      {Joint::kLeftBigToe, 10}};
    for (const auto& [joint, number] : numbers) {
        expect_joint(*seen.poses[3], joint, place_of(number));
        EXPECT_TRUE(motion::at(*seen.poses[3], joint).measured) << motion::info_of(joint).name;
    }
    expect_joint(*seen.poses[3], Joint::kNeck, (place_of(16) + place_of(17)) / 2.0);
    expect_joint(*seen.poses[3], Joint::kPelvis, (place_of(1) + place_of(2)) / 2.0);
    expect_unknown(*seen.poses[3], Joint::kLeftHeel);
}

TEST_F(BodyTracking, JointsAreInTheTrackingSpace) {
    script["spaces"] = {"view", "local"};  // the floor is taken to be 1.6 m below LOCAL, which is 1.3 m above it
    script["floor_m"] = -1.3;
    track({"bd"}, joints_at_their_places(0, 24));
    const Seen seen = run();
    ASSERT_TRUE(seen.poses.at(3));
    expect_joint(*seen.poses[3], Joint::kLeftKnee, place_of(4) + glm::dvec3(0, 0.3, 0));
    expect_joint(*seen.poses[3], Joint::kNose, {0, 1.56, -0.02});
}

TEST_F(BodyTracking, AnInactiveBodyIsNothing) {
    for (const char* kind : {"fb", "bd"}) {
        track({kind}, joints_at_their_places(0, 70));
        key(4)["body"]["active"] = false;
        key(7)["body"]["active"] = true;
        const Seen seen = run();
        ASSERT_EQ(seen.poses.size(), size_t{kFrames} + 1);
        for (size_t i = 0; i < seen.poses.size(); ++i)
            EXPECT_EQ(seen.poses[i].has_value(), i < 4 || i >= 7) << kind << i;
    }
}

TEST_F(BodyTracking, JointsThatCannotBeAreUnknown) {
    json joints = joints_at_their_places(0, 24);
    joints["4"]["at"] = {nullptr, 1, 0};  // left knee: no number
    joints["5"]["at"] = {0, 1e30, 0};     // right knee
    joints["7"]["at"] = {0, 0, 1000.5};   // left ankle
    joints["16"]["flags"] = "none";       // left shoulder, and with it the neck
    joints["8"]["at"] = {0, 0, 999.5};
    track({"bd"}, joints);
    const Seen seen = run();
    ASSERT_TRUE(seen.poses.at(3));
    for (const Joint joint :
         {Joint::kLeftKnee, Joint::kRightKnee, Joint::kLeftAnkle, Joint::kLeftShoulder, Joint::kNeck})
        expect_unknown(*seen.poses[3], joint);
    expect_joint(*seen.poses[3], Joint::kRightAnkle, {0, 0, 999.5});
    expect_joint(*seen.poses[3], Joint::kLeftHip, place_of(1));
}

TEST_F(BodyTracking, AConfidenceThatIsNoneIsNothing) {
    track({"fb"}, joints_at_their_places(0, 70));
    key(4)["body"]["confidence"] = nullptr;  // NaN
    key(6)["body"]["confidence"] = 0;
    key(8)["body"]["confidence"] = 3;
    const Seen seen = run();
    ASSERT_EQ(seen.poses.size(), size_t{kFrames} + 1);
    EXPECT_TRUE(seen.poses[3]);
    EXPECT_FALSE(seen.poses[4]);
    EXPECT_FALSE(seen.poses[6]);
    ASSERT_TRUE(seen.poses[8]);
    EXPECT_EQ(motion::at(*seen.poses[8], Joint::kLeftElbow).confidence, 1);
}

TEST_F(BodyTracking, ASourceThatIsRefusedIsFollowedByTheNext) {
    track({"fb", "full_body", "bd"}, joints_at_their_places(0, 84));
    const auto refuse = [&](int times) {
        script["fail"] = {
            {{"function", "xrCreateBodyTrackerFB"}, {"result", "XR_ERROR_FEATURE_UNSUPPORTED"}, {"times", times}}};
        return run().source;
    };
    EXPECT_EQ(refuse(0), BodySource::kMetaFullBody);
    EXPECT_EQ(refuse(1), BodySource::kMetaUpperBody);
    EXPECT_EQ(refuse(2), BodySource::kBd);
}

TEST_F(BodyTracking, AFrameThatCannotBeLocatedIsNothing) {
    for (const char* kind : {"fb", "bd"}) {
        track({kind}, joints_at_their_places(0, 70));
        const char* call = kind == std::string("fb") ? "xrLocateBodyJointsFB" : "xrLocateBodyJointsBD";
        script["fail"] = {{{"function", call}, {"result", "XR_ERROR_RUNTIME_FAILURE"}, {"skip", 3}}};
        const Seen seen = run();
        ASSERT_EQ(seen.poses.size(), size_t{kFrames} + 1);
        for (size_t i = 0; i < seen.poses.size(); ++i) EXPECT_EQ(seen.poses[i].has_value(), i != 3) << kind << i;
        script["fail"][0]["result"] = "XR_ERROR_SESSION_LOST";
        EXPECT_THROW(run(), xr::XrFailure) << kind;
    }
}

void expect_three_points(const Seen& seen) {
    ASSERT_EQ(seen.poses.size(), size_t{kFrames} + 1);
    ASSERT_TRUE(seen.poses[kFocused]);
    const motion::Pose& pose = *seen.poses[kFocused];
    expect_joint(pose, Joint::kNose, {0, 1.56, -0.02});
    expect_joint(pose, Joint::kLeftWrist, {-0.2, 1.27, -0.4});
    expect_joint(pose, Joint::kRightWrist, {0.2, 1.27, -0.4});
    for (const Joint joint : {Joint::kNose, Joint::kLeftWrist, Joint::kRightWrist})
        EXPECT_TRUE(motion::at(pose, joint).measured) << motion::info_of(joint).name;
    EXPECT_FALSE(motion::at(pose, Joint::kNeck).measured);
    expect_unknown(pose, Joint::kLeftElbow);
    expect_unknown(pose, Joint::kLeftKnee);
}

TEST_F(BodyTracking, ARuntimeWithoutBodiesGivesThreePoints) {
    script["extensions"] = {XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME};
    const Seen seen = run();
    EXPECT_EQ(seen.source, BodySource::kThreePoints);
    expect_three_points(seen);
}

TEST_F(BodyTracking, AHeadsetThatSeesNoBodyGivesThreePoints) {
    script["extensions"] = {XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME, XR_FB_BODY_TRACKING_EXTENSION_NAME,
                            XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME, XR_BD_BODY_TRACKING_EXTENSION_NAME};
    const Seen seen = run();
    EXPECT_EQ(seen.source, BodySource::kThreePoints);
    expect_three_points(seen);
}

TEST_F(BodyTracking, WornTrackersAreJoints) {
    key(0)["trackers"] = {{"waist", {{"at", {0, 1, 0.1}}}},
                          {"left_foot", {{"at", {-0.1, 0.1, 0}}}},
                          {"right_knee", {{"at", {0.1, 0.5, -0.1}}}}};
    const Seen seen = run();
    EXPECT_EQ(seen.source, BodySource::kWornTrackers);
    expect_three_points(seen);
    const motion::Pose& pose = seen.poses[kFocused].value();
    expect_joint(pose, Joint::kPelvis, {0, 1, 0.1});
    expect_joint(pose, Joint::kLeftAnkle, {-0.1, 0.1, 0});
    expect_joint(pose, Joint::kRightKnee, {0.1, 0.5, -0.1});
    for (const Joint joint : {Joint::kPelvis, Joint::kLeftAnkle, Joint::kRightKnee})
        EXPECT_TRUE(motion::at(pose, joint).measured) << motion::info_of(joint).name;
    expect_unknown(pose, Joint::kRightAnkle);
}

}  // namespace
}  // namespace neuvv::test
