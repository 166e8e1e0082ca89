// neuvv import on the command line: frames that neuvv export wrote become a clip again.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace neuvv
