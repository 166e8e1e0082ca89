// Recordings of the app Record3D.
#include "training/data/layouts/loaders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "support/temporary_folder.h"
#include "training/data/layouts/formats.h"

namespace neuvv {
namespace {

using nlohmann::json;

struct Record3D : testing::Test {
    TemporaryFolder folder;
    // The second camera is turned by 90 degrees about +Y, so it looks along −X, from (1, 2, 3). K is column by column.
    json metadata = {{"w", 64},
                     {"h", 48},
                     {"K", {90, 0, 0, 0, 95, 0, 31.5, 22.5, 1}},
                     {"fps", 60},
                     {"poses", {{0, 0, 0, 1, 0, 0, 0}, {0, std::sqrt(0.5), 0, std::sqrt(0.5), 1, 2, 3}}}};

    training::Rig read(training::Split split = training::Split::kTrain) const {
        write_text(folder.path / "EXR_RGBD" / "metadata.json", metadata.dump());
        for (const char* name : {"0.png", "1.png"})
            test::write_grey_png(folder.path / "EXR_RGBD" / "rgb" / name, 64, 48);
        return training::read_rig(folder.path, split);
    }
    void expect_bad(const char* key, const json& value, std::initializer_list<std::string> words) {
        const json good = metadata;
        metadata[key] = value;
        expect_input_error([&] { read(); }, words);
        metadata = good;
    }
};

TEST_F(Record3D, APointFallsWhereItShould) {
    const training::Rig rig = read();
    EXPECT_EQ(rig.format, "record3d");
    ASSERT_EQ(rig.cameras.size(), 1u);
    EXPECT_EQ(rig.cameras[0].name, "1");
    const glm::dvec2 found = test::pixel_of(rig.cameras[0], {1 - 2, 2 + 0.5, 3 - 0.4});
    EXPECT_NEAR(found.x, 31.5 + 90 * 0.4 / 2, 1e-9);
    EXPECT_NEAR(found.y, 22.5 - 95 * 0.5 / 2, 1e-9);
    ASSERT_EQ(rig.remarks.size(), 1u);
    EXPECT_NE(rig.remarks[0].find("several cameras"), std::string::npos);
}

TEST_F(Record3D, AnImagesOwnIntrinsicsWin) {
    metadata["perFrameIntrinsicCoeffs"] = {{1, 1, 1, 1}, {80, 85, 30, 20}};
    const interchange::Lens lens = read().cameras.at(0).lens;
    EXPECT_EQ(lens.fx, 80);
    EXPECT_EQ(lens.fy, 85);
    EXPECT_EQ(lens.cx, 30);
    EXPECT_EQ(lens.cy, 20);
}

TEST_F(Record3D, DamageIsNamed) {
    expect_bad("poses", {{0, 0, 0, 1, 0, 0, 0}}, {"metadata.json", "poses", "image 1"});
    expect_bad("poses", 3, {"poses", "array"});
    expect_bad("poses", {{0, 0, 0, 1, 0, 0, 0}, {0, 0, 0, 2, 0, 0, 0}}, {"poses[1]", "quaternion"});
    expect_bad("poses", {{0, 0, 0, 1, 0, 0, 0}, {0, 0, 0, 1}}, {"poses[1]"});
    expect_bad("K", {1, 2, 3}, {"K"});
    expect_bad("perFrameIntrinsicCoeffs", {{1, 1, 1, 1}, {1}}, {"perFrameIntrinsicCoeffs[1]"});
    expect_bad("w", 60, {"64×48", "60×48"});
    write_text(folder.path / "EXR_RGBD" / "rgb" / "first.png", "");
    expect_input_error([&] { read(); }, {"poses", "image first", "number"});
}

}  // namespace
}  // namespace neuvv
