// neuvv paint, and the images of render --paint.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/figure.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

// The verb comes first, then the scene and the layer.
std::vector<std::string> paint_call(std::vector<std::string> arguments, const std::string& scene,
                                    const std::string& layer) {
    arguments.insert(arguments.begin() + 1, {scene, layer});
    arguments.insert(arguments.begin(), "paint");
    return arguments;
}

struct CliPaint : CliGpu {
    std::string layer = file("layer.nvpaint");
    nlohmann::json paint(std::vector<std::string> arguments) {
        arguments.push_back("--json");
        const ProgramResult result = run_neuvv(paint_call(arguments, scene, layer));
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
    }
    media::Image image(const std::string& paints) {
        std::vector<std::string> arguments = {"render",   "--overwrite", scene,    "-o",   file("still.png"),
                                              "--frames", "1",           "--size", "40x40"};
        if (!paints.empty()) arguments.insert(arguments.end(), {"--paint", paints});
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return media::read_png(file("still.png"));
    }
};

const std::vector<std::string> kEverywhere = {"--box", "-9,-9,-9,9,9,9"};

std::vector<std::string> with_everywhere(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), kEverywhere.begin(), kEverywhere.end());
    return arguments;
}

TEST_F(CliPaint, RegionsAreErasedAndRestored) {
    const media::Image plain = image("");
    const auto half = paint({"region", "--colour", "#ff0000", "--box", "-9,-9,-9,0,9,9"});
    EXPECT_GT(half.at("colours"), 10);
    EXPECT_EQ(half.at("erased"), 0);
    const media::Image red = image(layer);
    EXPECT_NE(red.rgba, plain.rgba);
    EXPECT_NE(image(layer + ":tint:0.5").rgba, red.rgba);
    EXPECT_EQ(image(layer + ":normal:0").rgba, plain.rgba);
    paint(with_everywhere({"erase"}));
    const auto erased = paint({"info"});
    EXPECT_EQ(erased.at("edits"), erased.at("erased"));
    const media::Image gone = image(layer);
    for (size_t i = 3; i < gone.rgba.size(); i += 4) ASSERT_EQ(gone.rgba[i], 0);
    const auto cut = paint(with_everywhere({"restore", "--frames", "1"}));
    EXPECT_EQ(cut.at("erased"), 2 * erased.at("erased").get<int>()) << "before and after it";
    EXPECT_EQ(image(layer).rgba, plain.rgba) << "at that frame";
    EXPECT_EQ(paint(with_everywhere({"restore"})).at("edits"), 0);
}

TEST_F(CliPaint, BrushAndImageReachWhatTheCameraSees) {
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 40;
    voctree::write_nvv(scene, tree);
    const media::Image plain = image("");
    EXPECT_GT(paint({"brush", "--line", "10,20", "30,20", "--size", "40x40", "--at", "1", "--radius", "0.3", "--colour",
                     "#00ff00", "--follow", "run"})
                  .at("leaves"),
              3);
    EXPECT_NE(image(layer).rgba, plain.rgba);
    media::Image red(20, 20);
    for (size_t i = 0; i < red.rgba.size(); i += 4) red.rgba[i] = red.rgba[i + 3] = 255;
    media::write_png(file("red.png"), red);
    paint(with_everywhere({"restore"}));
    paint({"project", "--image", file("red.png"), "--at", "1", "--follow", "all"});
    const media::Image shown = image(layer);
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
    expect_refused({"paint", "erase", scene, layer}, 2, {"--box"});
    expect_refused({"paint", "region", scene, layer, "--sphere", "0,0,0,1"}, 2, {"--colour", "--hue"});
    expect_refused({"paint", "brush", scene, layer, "--line", "1,1"}, 2, {"--colour", "--density"});
    expect_refused({"paint", "brush", scene, layer, "--line", "1,1", "--colour", "clear"}, 2, {"--colour", "erase"});
    expect_refused({"paint", "region", scene, layer, "--sphere", "0,0,0,1", "--hue", "9", "--follow", "run"}, 2,
                   {"--hue", "--follow"});
    expect_refused({"paint", "region", scene, layer, "--sphere", "0,0,0,-1", "--hue", "9"}, 2, {"--sphere", "radius"});
    expect_refused({"paint", "region", scene, layer, "--sphere", "0,0,0,1", "--hue", "nan"}, 2, {"--hue"});
    expect_refused({"paint", "erase", scene, layer, "--box", "1,2,3"}, 2, {"--box", "6 numbers"});
    expect_refused({"paint", "erase", scene, layer, "--sphere", "1,2,x,3"}, 2, {"--sphere"});
    expect_refused({"paint", "erase", scene, layer, "--sphere", "1,2,nan,3"}, 2, {"--sphere"});
    expect_refused({"paint", "erase", scene, layer, "--sphere", "0,0,0,1", "--at", "9"}, 2, {"--at"});
    expect_refused({"paint", "erase", scene, layer, "--sphere", "0,0,0,1", "--frames", "2:9"}, 2, {"--frames"});
    expect_refused({"paint", "info", scene, layer}, 2, {"no such file"});
    expect_refused({"paint", "project", scene, layer, "--image", file("none.png")}, 2, {"none.png"});
    expect_refused({"render", scene, "-o", file("x.png"), "--paint", scene}, 2, {"not a layer of paint"});
    expect_refused({"render", scene, "-o", file("x.png"), "--direct", "--paint", layer}, 2, {"--paint"});
    paint(with_everywhere({"erase"}));
    expect_refused({"render", scene, "-o", file("x.png"), "--paint", layer + ":loud:1"}, 2, {"loud"});
    voctree::write_nvv(scene, test::random_tree({.seed = 2, .leaves = 200, .frames = 4}));
    expect_refused({"render", scene, "-o", file("x.png"), "--paint", layer}, 2, {"another scene"});
    expect_refused({"paint", "erase", scene, layer, "--sphere", "0,0,0,1"}, 2, {"another scene"});
}

// A stage with two copies of a solid performer. "anna" is sheared, stretched, mirrored and spins; "anna 2" stands
// beside it.
struct CliStagePaint : CliPaint {
    std::string show = file("show.gltf");
    const std::vector<std::string> anna = {"--node", "anna", "--time", "0.5"};

    void SetUp() override {
        tree = test::figure_tree();
        CliPaint::SetUp();
        said({"stage", "new", show});
        said({"stage", "add", show, scene, "--name", "anna", "--time", "loop", "--spin", "-40", "--matrix",
              "-2,0,0.45,0,0.55,2.4,0.22,0,0.25,0,1.1,0,0.19,-0.08,-0.94,1"});
        said({"stage", "duplicate", show, "anna", "--row", "9"});
    }
    static std::string said(const std::vector<std::string>& arguments) {
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.out;
    }
    nlohmann::json paint_stage(std::vector<std::string> arguments) {
        arguments.push_back("--json");
        return nlohmann::json::parse(said(paint_call(arguments, show, layer)));
    }
    nlohmann::json project(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"project", "--image", file("halves.png")});
        arguments.insert(arguments.end(), anna.begin(), anna.end());
        return paint_stage(arguments);
    }
    // At the same time.
    media::Image still() {
        said({"render", "--overwrite", show, "-o", file("still.png"), "--size", "96x72", "--time", "0.5"});
        return media::read_png(file("still.png"));
    }
    // Red on the left, green on the right.
    void write_halves() const {
        media::Image halves(96, 72);
        for (uint32_t y = 0; y < 72; ++y)
            for (uint32_t x = 0; x < 96; ++x) {
                halves.at(x, y)[x < 48 ? 0 : 1] = 255;
                halves.at(x, y)[3] = 255;
            }
        media::write_png(file("halves.png"), halves);
    }
    nlohmann::json listed(size_t performer) const {
        const auto nodes = nlohmann::json::parse(read_text(show))["nodes"];
        const auto extension = nodes[3 + performer]["extensions"]["NEUVV_performer"];
        return extension.value("paint", nlohmann::json::array());
    }
};

// Counts the performer's pixels that have the right colour, and the others. Leaves across the centre may have either
// colour.
struct Halves {
    uint32_t left = 0, right = 0, wrong = 0;
};
Halves halves_of(const media::Image& before, const media::Image& after) {
    Halves halves;
    for (uint32_t y = 0; y < 72; ++y)
        for (uint32_t x = 0; x < 96; ++x) {
            const uint8_t *was = before.at(x, y), *is = after.at(x, y);
            const int change = std::abs(is[0] - was[0]) + std::abs(is[1] - was[1]) + std::abs(is[2] - was[2]);
            if (change < 24 || (x >= 46 && x < 50)) continue;
            const bool red = is[0] > 2 * is[1], green = is[1] > 2 * is[0];
            halves.left += x < 48 && red;
            halves.right += x >= 48 && green;
            halves.wrong += x < 48 ? is[0] <= is[1] : is[1] <= is[0];
        }
    return halves;
}

TEST_F(CliStagePaint, AnImageLandsOnThePixelsOfTheStagesCamera) {
    write_halves();
    const media::Image before = still();
    const auto told = project({});
    EXPECT_GT(told.at("leaves"), 10);
    EXPECT_EQ(told.at("stage").at("name"), "anna");
    EXPECT_EQ(told.at("stage").at("added"), true);
    EXPECT_EQ(listed(0), nlohmann::json::parse(R"([{"uri": "layer.nvpaint"}])"));
    EXPECT_EQ(listed(1).size(), 0u) << "each copy has its own list";
    const Halves halves = halves_of(before, still());
    EXPECT_GT(halves.left, 60u);
    EXPECT_GT(halves.right, 60u);
    EXPECT_LE(halves.wrong, (halves.left + halves.right) / 20);
    EXPECT_EQ(project({"--camera", "camera"}).at("stage").at("added"), false) << "it is there already";
    EXPECT_EQ(listed(0).size(), 1u);

    const std::string text = said({"paint", "erase", show, file("b.nvpaint"), "--node", "4", "--sphere", "0,0,0,1"});
    EXPECT_NE(text.find("show.gltf: \"anna 2\" (node 4): paint layer 0"), std::string::npos) << text;
    EXPECT_NE(text.find("b.nvpaint"), std::string::npos) << text;
    said({"stage", "remove", show, "anna 2"});
    said({"paint", "erase", show, file("c.nvpaint"), "--box", "-9,-9,-9,9,9,9"});
    EXPECT_EQ(listed(0).size(), 2u) << "the only performer needs no name";
    const std::string saved = read_text(show);
    const auto none =
        nlohmann::json::parse(said({"paint", "erase", show, file("d.nvpaint"), "--json", "--sphere", "99,99,99,1"}));
    EXPECT_EQ(none.at("stage").at("added"), false);
    EXPECT_TRUE(none.at("stage").at("layer").is_null());
    EXPECT_FALSE(std::filesystem::exists(file("d.nvpaint"))) << "no leaf is there";
    expect_refused({"paint", "restore", show, file("d.nvpaint"), "--sphere", "0,0,0,1"}, 2, {"d.nvpaint", "no such"});
    std::filesystem::copy_file(file("c.nvpaint"), file("e.nvpaint"));
    const auto read = nlohmann::json::parse(said({"paint", "info", show, file("e.nvpaint"), "--json"}));
    EXPECT_EQ(read.at("stage").at("added"), false);
    EXPECT_TRUE(read.at("stage").at("layer").is_null()) << "to be read, it is put nowhere";
    EXPECT_EQ(read_text(show), saved);
    said({"stage", "paint", show, "anna", "--layer", "1", "--remove"});

    std::filesystem::remove(layer);
    said({"paint", "project", show, layer, "--time", "2.75", "--image", file("halves.png")});
    const Halves turned = halves_of(before, still());
    EXPECT_GT(turned.wrong, (turned.left + turned.right) / 5) << "painted when it had turned by 90 degrees";
}

TEST_F(CliStagePaint, AStageWithoutCamerasIsPaintedFromTheOrbit) {
    write_halves();
    said({"stage", "remove", show, "camera"});
    said({"stage", "remove", show, "anna 2"});
    said({"stage", "set", show, "--ambient", "1,1,1"});
    const media::Image before = still();
    nlohmann::json told = nlohmann::json::parse(
        said({"paint", "project", show, layer, "--json", "--time", "0.5", "--image", file("halves.png")}));
    EXPECT_EQ(told.at("stage").at("node"), 2);
    const Halves halves = halves_of(before, still());
    EXPECT_GT(halves.left, 60u);
    EXPECT_GT(halves.right, 60u);
    EXPECT_LE(halves.wrong, (halves.left + halves.right) / 20);
}

TEST_F(CliStagePaint, ABrushColoursThePixelThatItIsPutOn) {
    write_halves();
    const media::Image before = still();
    project({});
    const media::Image painted = still();
    glm::uvec2 at(0);  // a pixel of the performer, well inside its outline
    for (uint32_t x = 8; x < 88 && at.x == 0; ++x) {
        bool within = true;
        for (uint32_t dx = 0; dx < 9; ++dx)
            for (uint32_t dy = 0; dy < 9; ++dy) {
                const uint8_t *was = before.at(x + dx - 4, 32 + dy), *is = painted.at(x + dx - 4, 32 + dy);
                within = within && std::abs(was[0] - is[0]) + std::abs(was[1] - is[1]) > 24;
            }
        if (within) at = {x, 36};
    }
    ASSERT_NE(at.x, 0u);
    std::vector<std::string> brush = {
        "brush",    "--size", "96x72",    "--line", fmt::format("{},{}", at.x + 0.5, 36.5),
        "--radius", "0.1",    "--colour", "#0000ff"};
    brush.insert(brush.end(), anna.begin(), anna.end());
    EXPECT_GT(paint_stage(brush).at("leaves"), 3);
    const media::Image after = still();
    EXPECT_GT(after.at(at.x, at.y)[2], 2 * std::max(after.at(at.x, at.y)[0], after.at(at.x, at.y)[1]));
}

// The brush does not meet leaves that another layer has erased, unless that layer is hidden. Leaves that the painted
// layer itself has erased are not met either.
TEST_F(CliStagePaint, TheOtherLayersShow) {
    write_halves();
    const std::string mask = file("mask.nvpaint");
    said({"paint", "erase", show, mask, "--node", "anna", "--box", "-9,-9,-9,9,9,9"});
    EXPECT_EQ(project({}).at("leaves"), 0);
    EXPECT_EQ(listed(0).size(), 1u) << "what paints nothing is not listed";
    said({"stage", "paint", show, "anna", "--layer", "0", "--visible", "off"});
    EXPECT_GT(project({}).at("leaves"), 10);
    EXPECT_EQ(listed(0)[1]["uri"], "layer.nvpaint") << "the uppermost";
    said({"paint", "erase", show, layer, "--node", "anna", "--box", "-9,-9,-9,9,9,9"});
    const auto erased = project({});
    EXPECT_EQ(erased.at("erased"), erased.at("edits"));
}

TEST_F(CliStagePaint, WhatIsLookedAtIsTheFrameOfTheStagesTime) {
    const std::vector<std::string> red = {"region", "--colour", "red", "--box", "-9,-9,-9,9,9,9", "--follow", "run"};
    std::vector<std::string> on_stage = red, alone = red;
    on_stage.insert(on_stage.end(), {"--node", "anna", "--time", "0.5"});
    paint_stage(on_stage);
    const std::string staged = read_text(layer);
    std::filesystem::remove(layer);
    alone.insert(alone.end(), {"--at", "1"});
    paint(alone);
    EXPECT_EQ(read_text(layer), staged) << "half a second of a clip of two frames a second";
    std::filesystem::remove(layer);
    alone.back() = "0";
    paint(alone);
    EXPECT_NE(read_text(layer), staged);
}

TEST_F(CliStagePaint, WrongUseIsRefused) {
    write_halves();
    const std::string before = read_text(show);
    const auto refused = [&](const std::vector<std::string>& more, const std::vector<std::string>& parts) {
        expect_refused(paint_call(more, show, layer), 2, parts);
    };
    const std::vector<std::string> everywhere = {"erase", "--box", "-9,-9,-9,9,9,9"};
    refused(everywhere, {"--node", "2 performers", "3 \"anna\", 4 \"anna 2\""});
    refused({"erase", "--node", "floor", "--sphere", "0,0,0,1"}, {"--node", "floor", "3 \"anna\", 4 \"anna 2\""});
    refused({"erase", "--node", "nobody", "--sphere", "0,0,0,1"}, {"nobody", "anna"});
    refused({"erase", "--node", "anna", "--time", "nan", "--sphere", "0,0,0,1"}, {"--time"});
    const std::vector<std::string> image = {"project", "--node", "anna", "--image", file("halves.png")};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), image.begin(), image.end());
        return more;
    };
    refused(with({"--camera", "nobody"}), {"nobody", "camera"});
    refused(with({"--camera", "none.json"}), {"none.json"});
    refused(with({"--camera", "camera", "--key", "1"}), {"--key", "paths"});
    refused(with({"--every-frame", "--follow", "all"}), {"--every-frame", "--follow"});
    refused({"info", "--node", "anna"}, {"no such file"});
    expect_refused({"paint", "erase", scene, layer, "--time", "1", "--sphere", "0,0,0,1"}, 2, {"--time", "stages"});
    expect_refused({"paint", "erase", scene, layer, "--node", "anna", "--sphere", "0,0,0,1"}, 2, {"--node", "stages"});
    EXPECT_EQ(read_text(show), before);
    EXPECT_FALSE(std::filesystem::exists(layer));
    said({"stage", "remove", show, "anna"});
    said({"stage", "remove", show, "anna 2"});
    refused(everywhere, {"--node", "0 performers", "neuvv stage add"});
}

}  // namespace
}  // namespace neuvv
