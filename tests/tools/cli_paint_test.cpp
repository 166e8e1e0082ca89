// neuvv paint, and what render --paint shows of it.
#include <gtest/gtest.h>

#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

struct CliPaint : CliGpu {
    std::string layer = file("layer.nvpaint");
    nlohmann::json paint(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"paint", scene, layer, "--json"});
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
    }
    Image picture(const std::string& paints) {
        std::vector<std::string> arguments = {"render",   scene, "-o",     file("still.png"),
                                              "--frames", "1",   "--size", "40x40"};
        if (!paints.empty()) arguments.insert(arguments.end(), {"--paint", paints});
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return read_png(file("still.png"));
    }
};

const std::vector<std::string> kEverywhere = {"--box", "-9,-9,-9,9,9,9"};

std::vector<std::string> with_everywhere(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), kEverywhere.begin(), kEverywhere.end());
    return arguments;
}

TEST_F(CliPaint, RegionsAreErasedAndRestored) {
    const Image plain = picture("");
    const auto half = paint({"region", "--colour", "#ff0000", "--box", "-9,-9,-9,0,9,9"});
    EXPECT_GT(half.at("colours"), 10);
    EXPECT_EQ(half.at("erased"), 0);
    const Image red = picture(layer);
    EXPECT_NE(red.rgba, plain.rgba);
    EXPECT_NE(picture(layer + ":tint:0.5").rgba, red.rgba);
    EXPECT_EQ(picture(layer + ":normal:0").rgba, plain.rgba);
    paint(with_everywhere({"erase"}));
    const auto erased = paint({"info"});
    EXPECT_EQ(erased.at("edits"), erased.at("erased"));
    const Image gone = picture(layer);
    for (size_t i = 3; i < gone.rgba.size(); i += 4) ASSERT_EQ(gone.rgba[i], 0);
    const auto cut = paint(with_everywhere({"restore", "--frames", "1"}));
    EXPECT_EQ(cut.at("erased"), 2 * erased.at("erased").get<int>()) << "before and after it";
    EXPECT_EQ(picture(layer).rgba, plain.rgba) << "at that frame";
    EXPECT_EQ(paint(with_everywhere({"restore"})).at("edits"), 0);
}

TEST_F(CliPaint, BrushAndPictureReachWhatTheCameraSees) {
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf++)
        for (uint32_t c = 0; c < tree.bases; c++) tree.leaf(leaf)[c] *= 40;
    write_nvv(scene, tree);
    const Image plain = picture("");
    EXPECT_GT(paint({"brush", "--line", "10,20", "30,20", "--size", "40x40", "--at", "1", "--radius", "0.3", "--colour",
                     "#00ff00", "--follow", "run"})
                  .at("leaves"),
              3);
    EXPECT_NE(picture(layer).rgba, plain.rgba);
    Image red(20, 20);
    for (size_t i = 0; i < red.rgba.size(); i += 4) red.rgba[i] = red.rgba[i + 3] = 255;
    write_png(file("red.png"), red);
    paint(with_everywhere({"restore"}));
    paint({"project", "--image", file("red.png"), "--at", "1", "--follow", "all"});
    const Image shown = picture(layer);
    uint64_t redness = 0, before = 0, green = 0;
    for (size_t i = 0; i < shown.rgba.size(); i += 4) {
        redness += shown.rgba[i];
        before += plain.rgba[i];
        green += shown.rgba[i + 1];
    }
    EXPECT_GT(redness, before);
    EXPECT_LT(green, redness / 4) << "seen from where it was projected, everything is red";
}

TEST_F(CliPaint, WrongUseIsRefused) {
    expect_refused({"paint", scene, layer}, 2, {"neuvv paint --help"});
    expect_refused({"paint", scene, layer, "erase"}, 2, {"--box"});
    expect_refused({"paint", scene, layer, "erase", "--box", "1,2,3"}, 2, {"--box", "6 numbers"});
    expect_refused({"paint", scene, layer, "erase", "--sphere", "1,2,x,3"}, 2, {"--sphere"});
    expect_refused({"paint", scene, layer, "erase", "--sphere", "1,2,nan,3"}, 2, {"--sphere"});
    expect_refused({"paint", scene, layer, "erase", "--sphere", "0,0,0,1", "--at", "9"}, 2, {"--at"});
    expect_refused({"paint", scene, layer, "erase", "--sphere", "0,0,0,1", "--frames", "2:9"}, 2, {"--frames"});
    expect_refused({"paint", scene, layer, "info"}, 2, {"no such file"});
    expect_refused({"paint", scene, layer, "project", "--image", file("none.png")}, 2, {"none.png"});
    expect_refused({"render", scene, "-o", file("x.png"), "--paint", scene}, 2, {"not a layer of paint"});
    expect_refused({"render", scene, "-o", file("x.png"), "--direct", "--paint", layer}, 2, {"--paint"});
    paint(with_everywhere({"erase"}));
    expect_refused({"render", scene, "-o", file("x.png"), "--paint", layer + ":loud:1"}, 2, {"loud"});
    write_nvv(scene, test::random_tree({.seed = 2, .leaves = 200, .frames = 4}));
    expect_refused({"render", scene, "-o", file("x.png"), "--paint", layer}, 2, {"another scene"});
    expect_refused({"paint", scene, layer, "erase", "--sphere", "0,0,0,1"}, 2, {"another scene"});
}

}  // namespace
}  // namespace neuvv
