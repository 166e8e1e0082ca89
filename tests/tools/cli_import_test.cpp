// neuvv import on the command line: frames that neuvv export wrote become a clip again.
#include <gtest/gtest.h>

#include "interchange/splats/splat_ply.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

struct CliImport : CliGpu {
    nlohmann::json json_of(std::vector<std::string> arguments) {
        arguments.emplace_back("--json");
        const ProgramResult run = run_neuvv(arguments);
        EXPECT_EQ(run.code, 0) << run.err;
        return run.code == 0 ? nlohmann::json::parse(run.out) : nlohmann::json::object();
    }
};

TEST_F(CliImport, FramesOfVolumesBecomeAClip) {
    const std::vector<std::string> small = {"--views", "2", "--size", "48x48"};
    std::vector<std::string> to = {"export", scene, "-o", file("in_%02d.vdb"), "--frames", "0:2"};
    to.insert(to.end(), small.begin(), small.end());
    EXPECT_EQ(json_of(to).at("files"), 3);
    std::vector<std::string> from = {"import", file("in_%02d.vdb"), "-o", file("back.nvv"), "--fps", "10"};
    from.insert(from.end(), small.begin(), small.end());
    const nlohmann::json imported = json_of(from);
    EXPECT_EQ(imported.at("frames"), 3);
    EXPECT_GT(imported.at("leaves"), 0);
    EXPECT_GT(imported.at("psnr_db"), 15);
    EXPECT_LE(imported.at("worst_psnr_db"), imported.at("psnr_db"));
    const nlohmann::json info = json_of({"info", file("back.nvv")});
    EXPECT_EQ(info.at("frames"), 3);
    EXPECT_EQ(info.at("fps"), 10);
    std::filesystem::remove(file("in_01.vdb"));
    expect_refused({"import", file("in_%02d.vdb"), "-o", file("x.nvs")}, 2,
                   {"x.nvs", "in_%02d.vdb -o " + file("x.nvv") + "`", "neuvv publish " + file("x.nvv")});
    expect_refused({"import", file("in_%02d.vdb"), "-o", file("gap.nvv")}, 2, {"in_01.vdb", "is missing"});
    EXPECT_FALSE(std::filesystem::exists(file("gap.nvv")));
}

// Splats that are all as opaque as `opacity`, of which one floats far away.
interchange::Splats splats_of(float opacity, const glm::vec3& floater) {
    interchange::Splats splats{0, std::vector<interchange::Splat>(60)};
    for (size_t i = 0; i < splats.splats.size(); ++i) {
        interchange::Splat& splat = splats.splats[i];
        splat.centre = 0.1f * glm::vec3(i % 4, i / 4 % 4, i / 16);
        splat.deviation = glm::vec3(0.05f);
        splat.opacity = opacity;
        splat.colour[0] = {1, -1, -1};
    }
    splats.splats[30].centre = floater;
    return splats;
}

TEST_F(CliImport, SplatsThatShowNothingAreNoClip) {
    const std::vector<std::string> small = {"--views", "2", "--size", "32x32", "--resolution", "16"};
    const auto import = [&](const char* from, const char* to) {
        std::vector<std::string> arguments = {"import", file(from), "-o", file(to)};
        arguments.insert(arguments.end(), small.begin(), small.end());
        return arguments;
    };
    interchange::write_splat_ply(file("faint.ply"), splats_of(1e-3f, glm::vec3(0)));
    expect_refused(import("faint.ply", "faint.nvv"), 2, {"faint.ply", "60 splats, each less opaque"});
    EXPECT_FALSE(std::filesystem::exists(file("faint.nvv")));
    EXPECT_FALSE(std::filesystem::exists(file("faint.nvv.unfinished")));
    interchange::write_splat_ply(file("floater.ply"), splats_of(0.9f, {0, 0, 500}));
    const nlohmann::json imported = json_of(import("floater.ply", "floater.nvv"));
    EXPECT_EQ(imported.at("empty_views"), 0);
    EXPECT_GT(imported.at("psnr_db"), 15);
    ASSERT_EQ(imported.at("notes").size(), 1u);
    const auto note = imported.at("notes")[0].get<std::string>();
    EXPECT_NE(note.find("1 of 60 splats"), std::string::npos) << note;
    EXPECT_NE(note.find("splat 30 at"), std::string::npos) << note;
    EXPECT_NE(note.find("--box="), std::string::npos) << note;
}

}  // namespace
}  // namespace neuvv
