// The command line with a device: the files of render and convert, and a training.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/error.h"
#include "media/video.h"
#include "motion/video/triangulate.h"
#include "stage/stage.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"
#include "tests/tools/trace_spans.h"
#include "training/evaluation/metrics.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvv.h"

namespace neuvv {
namespace {

constexpr media::ImageSize kShownSize{64, 48};

// A frame's image as `neuvv render --frames` draws it.
media::Image shown(const gpu::Device& device, const voctree::VOctree& tree) {
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, {kShownSize.width, kShownSize.height, 2});
    render::FrameSettings settings;
    settings.width = kShownSize.width;
    settings.height = kShownSize.height;
    settings.samples = 2;
    settings.mode = render::TraceMode::kPlay;
    const auto path = tools::orbit_path(voctree::occupied_box(tree), {{0, 0}, kOwnFps, kOwnFps}, kShownSize);
    return renderer.render(path.front().camera, settings);
}

TEST_F(CliGpu, RenderWritesNumberedImages) {
    const ProgramResult result =
        run_neuvv({"render", "--overwrite", scene, "-o", file("new/out_%03d.png"), "--size", "40x24", "--json"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out).at("images"), 8);
    bool clear = false, seen = false;
    for (int i = 0; i < 8; ++i) {
        const media::Image image = media::read_png(folder.path / "new" / ("out_00" + std::to_string(i) + ".png"));
        EXPECT_EQ(image.width, 40u);
        EXPECT_EQ(image.height, 24u);
        for (size_t p = 3; p < image.rgba.size(); p += 4) {
            clear |= image.rgba[p] == 0;
            seen |= image.rgba[p] > 60;
        }
    }
    EXPECT_TRUE(clear && seen);
    EXPECT_FALSE(std::filesystem::exists(folder.path / "new" / "out_008.png"));
}

TEST_F(CliGpu, RenderWritesAVideo) {
    const ProgramResult result = run_neuvv(
        {"render", "--overwrite", scene, "-o", file("turn.mp4"), "--size", "64x48", "--fps", "3"}, "NEUVV_TRACE=1");
    ASSERT_EQ(result.code, 0) << result.err;
    const media::VideoSummary video = media::summarise_video(file("turn.mp4"));
    EXPECT_EQ(video.width, 64u);
    EXPECT_EQ(video.height, 48u);
    EXPECT_EQ(video.frames, 12u);
    EXPECT_NEAR(video.fps, 3, 1e-6);
    EXPECT_NE(result.err.find("trace"), std::string::npos) << "pass times";
    EXPECT_EQ(folder.entries(), 2u) << "no temporary is left";
}

// Images are encoded while the next ones are drawn.
TEST_F(CliGpu, ATraceShowsWhatHappensAtTheSameTime) {
    const ProgramResult result = run_neuvv(
        {"render", "--overwrite", scene, "-o", file("o_%02d.png"), "--size", "320x320", "--trace", file("trace.json")});
    ASSERT_EQ(result.code, 0) << result.err;
    auto spans = spans_of(nlohmann::json::parse(std::ifstream(file("trace.json"))));
    const auto& waits = spans["main thread: wait for the device: frame"];
    size_t writes = 0, overlapping = 0;
    for (const auto& [name, events] : spans) {
        if (name.find("worker: write image") == std::string::npos) continue;
        for (const auto& write : events) {
            ++writes;
            overlapping += std::ranges::any_of(waits, [&](const auto& wait) { return overlap(write, wait); });
        }
    }
    EXPECT_EQ(writes, 8u);
    EXPECT_GT(overlapping, 0u);
}

TEST_F(CliGpu, ATraceHasTheSpansOfThreadsAndOfTheDevice) {
    const ProgramResult result = run_neuvv({"render", "--overwrite", scene, "-o", file("one_%d.png"), "--frames", "0",
                                            "--size", "16x16", "--trace", file("trace.json")});
    ASSERT_EQ(result.code, 0) << result.err;
    const auto trace = nlohmann::json::parse(std::ifstream(file("trace.json")));
    auto spans = spans_of(trace);
    const auto& waits = spans["main thread: wait for the device: frame"];
    ASSERT_FALSE(waits.empty());
    for (const auto& wait : waits) EXPECT_GE(wait.at("dur").get<double>(), 0);
    size_t on_device = 0;
    for (const auto& [name, events] : spans) on_device += name.starts_with("main thread") ? 0 : events.size();
    EXPECT_GT(on_device, 0u);
    EXPECT_EQ(trace.at("otherData").at("spans left out"), 0);

    const ProgramResult refused =
        run_neuvv({"info", scene, "--trace", (folder.path / "scene.nvv" / "trace.json").string()});
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("--trace"), std::string::npos);
}

TEST_F(CliGpu, RenderShowsBackgroundAlphaDepthAndTheDirectPath) {
    const auto image = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"render",   "--overwrite", scene,    "-o",   file("one_%d.png"),
                                              "--frames", "1.5",         "--size", "32x32"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return media::read_png(file("one_0.png"));
    };
    const media::Image colour = image({}), direct = image({"--direct"}), green = image({"--background", "#00ff00"});
    const media::Image alpha = image({"--alpha"}), depth = image({"--depth"});
    for (size_t i = 0; i < colour.rgba.size(); ++i) {
        const size_t pixel = i / 4 * 4;
        EXPECT_NEAR(colour.rgba[i], direct.rgba[i], colour.rgba[pixel + 3] > 0 ? 1 : 255);
        EXPECT_TRUE(i % 4 < 3 || green.rgba[i] == 255);
        EXPECT_NEAR(alpha.rgba[i], i % 4 < 3 ? colour.rgba[pixel + 3] : 255, 1);
    }
    EXPECT_EQ(colour.rgba[3], 0);
    EXPECT_EQ(std::vector<uint8_t>(green.rgba.begin(), green.rgba.begin() + 4), (std::vector<uint8_t>{0, 255, 0, 255}));
    EXPECT_EQ(depth.rgba[0], 0);  // the background, which is far
    EXPECT_GT(*std::max_element(depth.rgba.begin(), depth.rgba.end() - 1), 60);
    const media::Image level = image({"--level"}), cost = image({"--cost"}),
                       cheap = image({"--cost", "--cost-max", "4"});
    EXPECT_NE(level.rgba, cost.rgba);
    EXPECT_NE(cost.rgba, cheap.rgba);
    for (size_t i = 0; i < colour.rgba.size(); i += 4) {
        const auto any = [&](const media::Image& of) { return of.rgba[i] + of.rgba[i + 1] + of.rgba[i + 2] > 0; };
        EXPECT_TRUE(colour.rgba[i + 3] == 0 || any(cost)) << "what is seen has cost something";
        EXPECT_TRUE(colour.rgba[i + 3] < 255 || any(level)) << "what is solid has a level";
        EXPECT_TRUE(colour.rgba[i + 3] > 0 || !any(level)) << "what is not seen has none";
    }
}

TEST_F(CliGpu, AnEmptySceneRenders) {
    tree.weights.clear();
    voctree::build_topology(tree, {});
    voctree::write_nvv(scene, tree);
    EXPECT_EQ(shown(device(), voctree::read_nvv(scene)).rgba, media::Image(kShownSize.width, kShownSize.height).rgba);
}

TEST_F(CliGpu, AnInstantIntoOneImageIsAStill) {
    const ProgramResult result =
        run_neuvv({"render", "--overwrite", scene, "-o", file("still.png"), "--frames", "1.5", "--size", "40x24"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(media::read_png(file("still.png")).width, 40u);
}

TEST_F(CliGpu, OneImageShowsTheFirstFrameWhereNoneIsNamed) {
    const std::string key = file("key.json");
    write_text(key, R"({"path":[{"R":[0,0,0,1],"T":[0.5,0.5,2],"fov":40}],"time":0})");
    const auto image = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"render", "--overwrite", scene, "-o", file("still.png"), "--size", "40x24"};
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult result = run_neuvv(words);
        EXPECT_EQ(result.code, 0) << result.err;
        return media::read_png(file("still.png")).rgba;
    };
    EXPECT_EQ(image({}), image({"--frames", "0"}));
    EXPECT_NE(image({}), image({"--frames", "3"}));
    EXPECT_EQ(image({"--camera", key}), image({"--camera", key, "--frames", "0"}));
    expect_refused({"render", "--overwrite", scene, "-o", file("still.png"), "--frames", "0:1"}, 2,
                   {"is one file for", "one time by --frames"});
}

TEST_F(CliGpu, ConvertKeepsTheQualityThatWasAskedFor) {
    const std::vector<std::string> command = {"convert",         "--overwrite", scene,   "-o",
                                              file("small.nvv"), "--size",      "64x48", "--json"};
    const auto with_quality = [&](const char* quality) {
        std::vector<std::string> arguments = command;
        arguments.insert(arguments.end(), {"--quality", quality});
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return nlohmann::json::parse(result.out);
    };
    const nlohmann::json fine = with_quality("60"), coarse = with_quality("35");
    EXPECT_GE(fine["psnr_db"], 60.0);
    EXPECT_GE(coarse["psnr_db"], 35.0);
    EXPECT_LT(coarse["psnr_db"], fine["psnr_db"]);
    EXPECT_LT(coarse["bytes"], fine["bytes"]);
    EXPECT_LT(fine["bytes"], fine["bytes_before"]);
    EXPECT_EQ(coarse["bytes_before"], std::filesystem::file_size(scene));
    EXPECT_EQ(coarse["bytes"], std::filesystem::file_size(file("small.nvv")));
    EXPECT_EQ(voctree::read_nvv(file("small.nvv")).leaf_count, coarse["leaves"]);
    EXPECT_EQ(voctree::summarise_nvv(file("small.nvv")).header.frames, tree.frames);

    std::filesystem::remove(file("small.nvv"));
    const ProgramResult beyond =
        run_neuvv({"convert", "--overwrite", scene, "-o", file("small.nvv"), "--quality", "90", "--size", "64x48"});
    EXPECT_EQ(beyond.code, 2);
    EXPECT_NE(beyond.err.find("scene.nvv: the finest steps show"), std::string::npos) << beyond.err;
    expect_refused({"convert", scene, "-o", file("small.nvv"), "--quality", "nan"}, 2, {"--quality"});
    expect_refused({"convert", file("none.nvv"), "-o", file("small.nvv")}, 2, {"none.nvv"});
    expect_refused({"convert", scene, "-o", scene}, 2, {"--output", "is what scene names"});
    EXPECT_FALSE(std::filesystem::exists(file("small.nvv")));
}

// The same image from the PlenOctree itself and from the .nvv that it is converted to, with either axis up.
TEST_F(CliGpu, PlenoctreesAreClips) {
    const std::string tree_npz = file("tree.npz");
    std::filesystem::copy(NEUVV_SOURCE_DIR "/tests/fuzz/corpus/plenoctree/tiny/scene.npz", tree_npz);
    const auto run = [](const std::vector<std::string>& arguments) {
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.out;
    };
    const voctree::VOctree expected = voctree::read_clip(tree_npz);
    const nlohmann::json facts = nlohmann::json::parse(run({"info", tree_npz, "--check", "--json"}));
    EXPECT_EQ(facts.at("format"), "PlenOctree");
    EXPECT_EQ(facts.at("leaves"), expected.leaf_count);
    EXPECT_EQ(facts.at("bytes"), std::filesystem::file_size(tree_npz));
    EXPECT_NE(run({"info", tree_npz}).find("1 frames"), std::string::npos);

    const auto rendered = [&](std::vector<std::string> more) {
        std::vector<std::string> words = {"render",   "--overwrite", tree_npz, "-o",   file("seen.png"),
                                          "--frames", "0",           "--size", "64x48"};
        words.insert(words.end(), more.begin(), more.end());
        run(words);
        return media::read_png(file("seen.png"));
    };
    const media::Image seen = rendered({}), with_y_up = rendered({"--up", "y"});
    EXPECT_GT(training::compare(seen, media::Image(64, 48)).mae, 0.01) << "nothing is to be seen";
    // Colours of a .nvv are mixed as linear light, which is up to 5/255 lighter where it is half transparent.
    const auto linear = [&](const voctree::VOctree& same) {
        voctree::write_nvv(file("linear.nvv"), same);
        return shown(device(), voctree::read_nvv(file("linear.nvv")));
    };
    EXPECT_GT(training::compare(seen, linear(expected)).psnr, 34);

    run({"convert", "--overwrite", tree_npz, "-o", file("y.nvv"), "--size", "64x48", "--quality", "50", "--up", "y"});
    EXPECT_EQ(nlohmann::json::parse(run({"info", file("y.nvv"), "--json"})).at("format"), "nvv");
    const voctree::VOctree with_y =
        voctree::read_clip(tree_npz, voctree::PlenoctreeColours::kLinear, voctree::UpAxis::kY);
    const media::Image converted = shown(device(), voctree::read_nvv(file("y.nvv")));
    EXPECT_GT(training::compare(linear(with_y), converted).psnr, 45);
    EXPECT_GT(training::compare(with_y_up, converted).psnr, 34);
    EXPECT_LT(training::compare(with_y_up, seen).psnr, 30);
    expect_refused({"render", scene, "-o", file("y.png"), "--up", "y"}, 2, {"--up", "is no PlenOctree"});

    run({"stage", "new", file("show.gltf")});
    run({"stage", "add", file("show.gltf"), tree_npz, "--name", "tree", "--up", "y"});
    const stage::Stage show = stage::load_stage(file("show.gltf"));
    const glm::dvec3 up = show.scene.nodes[show.performers[0].node].rotation * glm::dvec3(0, 0, -1);
    EXPECT_NEAR(up.y, 1, 1e-6) << "the file's y, which is -z of the clip";
    EXPECT_EQ(nlohmann::json::parse(run({"stage", "info", file("show.gltf"), "--json"})).at("clips")[0].at("frames"),
              1);
    run({"render", "--overwrite", file("show.gltf"), "-o", file("shown.png"), "--time", "0", "--size", "64x48"});
    write_text(file("tree.npz"), "PK\3\4");
    expect_refused({"render", tree_npz, "-o", file("seen.png")}, 2, {"tree.npz"});
}

TEST_F(CliGpu, RenderTracesFewerRaysThanPixels) {
    const std::vector<std::string> command = {"render",   "--overwrite", scene,    "-o",   file("half.png"),
                                              "--frames", "1",           "--size", "64x48"};
    std::vector<std::string> scaled = command;
    for (const char* word : {"--scale", "0.5", "--json"}) scaled.push_back(word);
    const ProgramResult half = run_neuvv(scaled);
    ASSERT_EQ(half.code, 0) << half.err;
    EXPECT_EQ(media::read_png(file("half.png")).width, 64u);
    scaled.push_back("--samples");
    scaled.push_back("2");
    expect_refused(scaled, 2, {"--samples", "--scale"});
    expect_refused({"render", scene, "-o", file("a.png"), "--scale", "0"}, 2, {"--scale"});
}

TEST_F(CliGpu, TrainBeginsWithPsiAndASpentRunStaysAsItIs) {
    write_own_data();
    std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    std::vector<std::string> command = {"train", file("data"), "-o", file("run.nvv"), "--metrics", file("m.jsonl")};
    std::vector<std::string> first = command;
    for (const char* word : {"--init", "psi", "--psi-steps", "2", "--steps", "3", "--resolution", "32"})
        first.push_back(word);
    const ProgramResult run = run_neuvv(first);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.err.find("psi: "), std::string::npos) << run.err;
    EXPECT_NE(run.out.find("after 3 steps"), std::string::npos) << run.out;
    EXPECT_GT(voctree::read_nvv(file("run.nvv")).leaf_count, 0u);
    const std::string metrics = read_text(file("m.jsonl"));
    EXPECT_GT(count_of(metrics, "\n"), 0u);

    command.push_back("--resume");
    const ProgramResult again = run_neuvv(command);
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_NE(again.out.find("spent"), std::string::npos) << again.out;
    EXPECT_EQ(read_text(file("m.jsonl")), metrics);
}

TEST_F(CliGpu, AnUnwritablePlaceIsBadInput) {
    write_text(file("wall"), "a file where a folder should be");
    expect_refused({"render", scene, "-o", file("wall/x.mp4"), "--size", "16x16"}, 2, {"--output", "wall"});
    expect_refused({"dataset", file(""), "-o", file("wall/x")}, 2, {"--output", "wall"});
    expect_refused({"capture", file("none.glb"), "-o", file("wall/x")}, 2, {"--output", "wall"});
    ASSERT_EQ(mkfifo(file("pipe.png").c_str(), 0600), 0);
    expect_refused({"render", scene, "-o", file("pipe.png"), "--frames", "0"}, 2, {"--output", "no regular file"});
}

TEST_F(CliGpu, ALinkStaysAndItsTargetIsReplaced) {
    write_text(file("target.png"), "old");
    std::filesystem::create_symlink("target.png", folder.path / "link.png");
    const ProgramResult result =
        run_neuvv({"render", "--overwrite", scene, "-o", file("link.png"), "--frames", "0", "--size", "16x16"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path / "link.png"));
    EXPECT_EQ(media::read_png(folder.path / "target.png").width, 16u);

    std::filesystem::create_directory(folder.path / "videos");
    std::filesystem::create_symlink("videos/turn.mp4", folder.path / "link.mp4");  // the target does not exist yet
    const ProgramResult video = run_neuvv(
        {"render", "--overwrite", scene, "-o", file("link.mp4"), "--frames", "0", "--size", "16x16", "--fps", "1"});
    ASSERT_EQ(video.code, 0) << video.err;
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path / "link.mp4"));
    EXPECT_EQ(media::summarise_video(folder.path / "videos/turn.mp4").width, 16u);
}

TEST_F(CliGpu, OddVideosAreReportedAsEncoded) {
    const ProgramResult result = run_neuvv({"render", "--overwrite", scene, "-o", file("odd.mp4"), "--frames", "0",
                                            "--size", "17x31", "--fps", "1", "--json"});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("\"width\": 18"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("\"height\": 32"), std::string::npos) << result.out;
}

// Copies share their clip, so they take no further memory.
TEST_F(CliGpu, StageInfoMeasuresEachClipOnce) {
    const std::string show = file("show.gltf");
    test::write_stage(show, scene, "anna");
    const auto bytes = [&](const std::string& budget) {
        const ProgramResult result = run_neuvv({"stage", "info", show, "--memory", "--json", "--slice-budget", budget});
        EXPECT_EQ(result.code, 0) << result.err;
        const auto json = nlohmann::json::parse(result.out);
        EXPECT_EQ(json.at("clips").size(), 1u);
        return json.at("device_bytes").get<uint64_t>();
    };
    const uint64_t one = bytes("256");
    EXPECT_GT(one, tree.leaf_count * tree.weights_per_leaf() * 2u) << "weights in half precision at least";
    EXPECT_LT(bytes("0"), one) << "no slices";
    ASSERT_EQ(run_neuvv({"stage", "duplicate", show, "anna", "--count", "9", "--row", "1"}).code, 0);
    EXPECT_EQ(bytes("256"), one);
}

}  // namespace
}  // namespace neuvv
