// The corrections of a clip's rig as a file.
#include "training/rig/rig_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

training::RigCorrection three_cameras() {
    training::RigCorrection correction{{true, false, true}, {"left", "right", "\"top\" ü"}, {}};
    correction.changes.poses = {{}, {0.01, -0.02, 0.003, 0.1, -0.2, 0.3, 0.01}, {}};
    correction.changes.frames_late = {0, 1, -0.25};
    correction.changes.readout = {0, 0.5, -0.6};
    return correction;
}

void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
}

TEST(RigFile, ComesBackAsItWas) {
    const TemporaryFolder folder;
    EXPECT_FALSE(training::read_rig_correction(folder.path));
    training::RigCorrection written = three_cameras();
    for (const bool poses : {true, false})
        for (const bool time : {true, false}) {
            if (!poses) written.changes.poses.clear();
            written.changes.frames_late = time ? three_cameras().changes.frames_late : std::vector<double>();
            written.changes.readout = time ? three_cameras().changes.readout : std::vector<double>();
            training::write_rig_correction(folder.path, written);
            const auto read = training::read_rig_correction(folder.path);
            ASSERT_TRUE(read);
            EXPECT_EQ(read->changes, written.changes);
            EXPECT_EQ(read->cameras, written.cameras);
            EXPECT_TRUE(read->colour.colour && read->colour.vignetting && !read->colour.exposure);
        }
}

TEST(RigFile, ASegmentTakesTheChangesOfItsCameras) {
    const training::RigCorrection correction = three_cameras();
    std::vector<training::RigCamera> cameras(3);
    cameras[0].name = "\"top\" ü", cameras[1].name = "new", cameras[2].name = "right";
    const training::RigChanges changes = training::changes_of(correction, cameras);
    ASSERT_EQ(changes.poses.size(), 3u);
    EXPECT_EQ(changes.poses[0], training::PoseChange{});
    EXPECT_EQ(changes.poses[1], training::PoseChange{});
    EXPECT_EQ(changes.poses[2], correction.changes.poses[1]);
    EXPECT_EQ(changes.frames_late, (std::vector<double>{-0.25, 0, 0})) << "what is left of whole frames";
    EXPECT_EQ(changes.readout, (std::vector<double>{-0.6, 0, 0.5}));
    EXPECT_TRUE(training::changes_of({{}, {"left"}, {}}, cameras).empty());
}

// A camera that is late by a frame gives each segment the images that it took a frame later.
TEST(RigFile, LateShotsMoveBeforeAClipIsCut) {
    training::Rig rig;
    rig.cameras.resize(2);
    rig.cameras[0].name = "left", rig.cameras[1].name = "right";
    for (uint32_t camera = 0; camera < 2; ++camera)
        for (int frame = 0; frame < 4; ++frame)
            rig.shots.push_back({camera, frame / 3.0, std::to_string(camera) + std::to_string(frame), "", {}, {}});
    training::move_late_shots(three_cameras(), rig);
    const auto names_at = [&](int frame) {
        std::string names;
        for (const training::Shot& shot : rig.shots)
            if (shot.time == frame / 3.0) names += shot.name + " ";
        return names;
    };
    EXPECT_EQ(names_at(0), "00 ");
    EXPECT_EQ(names_at(2), "02 11 ");
    EXPECT_EQ(names_at(3), "03 12 ");
    EXPECT_EQ(rig.shots.size(), 7u) << "the last one shows what comes after the clip";
}

TEST(RigFile, DamageIsNamed) {
    const TemporaryFolder folder;
    const std::filesystem::path file = training::rig_file(folder.path);
    const auto refused = [&](const std::string& text, const std::string& part) {
        write(file, text);
        expect_input_error([&] { training::read_rig_correction(folder.path); }, {"rig.json", part});
    };
    const auto with = [](const std::string& members) {
        return R"({"neuvv_rig": 1, "colour": false, "exposure": false, "vignetting": false, )" + members + "}";
    };
    refused("{", "rig.json");
    refused(R"({"neuvv_rig": 2})", "neuvv_rig");
    refused(with(R"("poses": 3, "time": false, "cameras": [])"), "poses");
    refused(with(R"("poses": false, "time": false, "cameras": [])"), "cameras");
    refused(with(R"("poses": false, "time": true, "cameras": [{"name": "a", "frames_late": 7}])"), "frames_late");
    refused(with(R"("poses": true, "time": false, "cameras": [{"name": "a", "turn_x": 0}])"), "turn_y");
    refused(with(R"("poses": true, "time": false, "cameras": [{"name": "a", "turn_x": 9, "turn_y": 0, "turn_z": 0,
                    "shift_x": 0, "shift_y": 0, "shift_z": 0, "log_focal": 0}])"),
            "cameras[0]");
}

}  // namespace
}  // namespace neuvv::test
