// Data sets that the command line makes: captures, and views of a clip with its joints.
#include <gtest/gtest.h>
#include <signal.h>

#include <map>

#include "media/image.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/video/triangulate.h"
#include "stage/stage.h"
#include "support/child_process.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

TEST_F(CliGpu, SkeletonViewsAreADataSetOfTheWholeClip) {
    const std::vector<std::string> words = {"skeleton", "views", scene,    "-o",   file("views"),
                                            "--views",  "4",     "--size", "64x72"};
    const ProgramResult result = run_neuvv(words);
    ASSERT_EQ(result.code, 0) << result.err;
    const training::Dataset views =
        training::load_dataset(file("views"), training::Split::kTrain, {.mattes_needed = false});
    ASSERT_EQ(views.cameras.size(), 4u);
    ASSERT_EQ(views.views.size(), 4u * tree.frames);
    EXPECT_DOUBLE_EQ(views.fps, double{kOwnFps});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device(), field, {64, 72, 2});
    render::FrameSettings settings;
    settings.width = 64;
    settings.height = 72;
    settings.samples = 2;
    settings.mode = render::TraceMode::kPlay;
    settings.resolve.background = {0.2f, 0.2f, 0.2f, 1};
    for (const training::View& view : views.views) {
        settings.instances[0].frame = static_cast<float>(view.time * (tree.frames - 1));
        const media::Image expected = renderer.render(views.cameras[view.camera], settings);
        EXPECT_EQ(view.image.whole().rgba, expected.rgba) << view.name;
    }
    // The whole clip is in every image.
    const auto box = voctree::occupied_box(tree);
    for (const stage::Camera& camera : views.cameras)
        for (int corner = 0; corner < 8; ++corner) {
            const auto pixel = motion::project(
                camera, {corner & 1 ? box.second.x : box.first.x, corner & 2 ? box.second.y : box.first.y,
                         corner & 4 ? box.second.z : box.first.z});
            ASSERT_TRUE(pixel);
            EXPECT_TRUE(pixel->x >= 0 && pixel->y >= 0 && pixel->x <= 64 && pixel->y <= 72);
        }
    expect_refused({"skeleton", "views", scene, "-o", file("others"), "--views", "1"}, 2, {"--views", "2 to 100"});
}

TEST_F(CliGpu, SkeletonViewsReplaceEarlierOnesAndTheirKeyPoints) {
    const auto views = [&](const char* count) {
        return std::vector<std::string>{"skeleton", "views", scene,    "-o",   file("views"),
                                        "--views",  count,   "--size", "64x64"};
    };
    ASSERT_EQ(run_neuvv(views("4")).code, 0);
    std::filesystem::create_directory(file("views/key_points"));
    const std::string key_points = file("views/key_points/c03_f000_keypoints.json");
    write_text(key_points, "{}");
    expect_refused(views("3"), 2, {"views", "is there already", "--overwrite"});
    std::vector<std::string> again = views("3");
    again.emplace_back("--overwrite");
    const ProgramResult result = run_neuvv(again);
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_FALSE(std::filesystem::exists(key_points)) << "of an image that is gone";
    EXPECT_FALSE(std::filesystem::exists(file("views/images/c03_f000.png")));
    EXPECT_TRUE(std::filesystem::exists(file("views/images/c02_f000.png")));
    EXPECT_FALSE(std::filesystem::exists(file("views/unfinished")));
}

// The files of a folder, by their names in it.
std::map<std::string, std::string> contents_of(const std::string& folder) {
    std::map<std::string, std::string> contents;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            contents[entry.path().lexically_relative(folder).string()] = read_text(entry.path());
    return contents;
}

TEST_F(CliGpu, ACaptureReplacesAnotherOnceItIsWhole) {
    const std::string model = NEUVV_SOURCE_DIR "/tools/performer/performer.glb", data = file("data");
    const auto capture = [&](const char* cameras, const char* frames) {
        return std::vector<std::string>{"capture",  model,  "-o",     data,    "--cameras",  cameras,
                                        "--frames", frames, "--size", "32x32", "--overwrite"};
    };
    ASSERT_EQ(run_neuvv(capture("6", "2")).code, 0);
    const auto old = contents_of(file("data"));
    EXPECT_TRUE(old.contains("images/c05_f001.png"));
    std::vector<std::string> words = capture("12", "2000");
    words.insert(words.begin(), NEUVV_PROGRAM);
    for (const int signal : {SIGINT, SIGKILL}) {
        SCOPED_TRACE(signal);
        test::ChildProcess child(words, folder.path / "log.txt");
        ASSERT_TRUE(child.until([&] { return std::filesystem::exists(file("data/unfinished/images/c11_f000.png")); }))
            << read_text(folder.path / "log.txt");
        child.send(signal);
        EXPECT_EQ(child.wait(), signal == SIGKILL ? -SIGKILL : 1);
        auto left = contents_of(file("data"));
        std::erase_if(left, [](const auto& one) { return one.first.starts_with("unfinished/"); });
        EXPECT_EQ(left, old);
    }
    std::filesystem::create_directories(file("data/mattes"));
    write_text(file("data/mattes/c00_f000.png"), "of the old image");
    ASSERT_EQ(run_neuvv(capture("5", "1")).code, 0);
    EXPECT_FALSE(std::filesystem::exists(file("data/mattes/c00_f000.png")))
        << "it would overrule the new image's alpha";
    EXPECT_FALSE(std::filesystem::exists(file("data/unfinished"))) << "what a killed program leaves is removed";
    const auto now = contents_of(file("data"));
    for (const auto& [name, content] : now) {
        EXPECT_TRUE(old.contains(name) || name.starts_with("images/")) << name;
        EXPECT_FALSE(name.starts_with("images/c05") || name.ends_with("_f001.png")) << "an old image: " << name;
    }
    EXPECT_NE(now.at("transforms_train.json"), old.at("transforms_train.json"));
    EXPECT_EQ(training::load_dataset(file("data"), training::Split::kTrain).times.size(), 1u);
}

TEST_F(CliGpu, ACaptureOfAStudioIsReplacedLikeOthers) {
    const std::string model = NEUVV_SOURCE_DIR "/tools/performer/performer.glb", data = file("data");
    std::vector<std::string> words = {"capture",  model, "-o",     data,    "--cameras",  "7",
                                      "--frames", "2",   "--size", "32x32", "--overwrite"};
    ASSERT_EQ(run_neuvv(words).code, 0);
    const auto clean = contents_of(data);
    const auto with = [&](const char* seed) {
        std::vector<std::string> studio = words;
        studio.insert(studio.end(), {"--studio", seed});
        return studio;
    };
    ASSERT_EQ(run_neuvv(with("1")).code, 0);
    const auto studio = contents_of(data);
    size_t jpegs = 0, mattes = 0;
    for (const auto& [name, content] : studio) {
        jpegs += name.starts_with("images/") && name.ends_with(".jpg") ? 1 : 0;
        mattes += name.starts_with("mattes/") ? 1 : 0;
    }
    EXPECT_TRUE(studio.contains("studio.json"));
    EXPECT_EQ(jpegs, 12u) << "of six cameras that train";
    EXPECT_EQ(mattes, 12u);
    ASSERT_EQ(run_neuvv(with("1")).code, 0);
    EXPECT_EQ(contents_of(data), studio) << "a seed gives the same files";
    std::vector<std::string> videos = with("1");
    videos.emplace_back("--videos");
    ASSERT_EQ(run_neuvv(videos).code, 0);
    const auto recorded = contents_of(data);
    EXPECT_TRUE(recorded.contains("videos/c00.mp4"));
    for (const auto& [name, content] : recorded)
        EXPECT_FALSE(name.starts_with("images/") || name.starts_with("mattes/")) << name;
    std::filesystem::create_directories(file("data/mattes"));
    write_text(file("data/mattes/videos_c00_000001.png"), "as `neuvv matte` calls it");
    ASSERT_EQ(run_neuvv(words).code, 0);
    EXPECT_EQ(contents_of(data), clean) << "neither videos nor their mattes are left";
    words.emplace_back("--videos");
    expect_refused(words, 2, {"--videos", "--background checker or --studio"});
    words.pop_back();
    expect_refused(with("-1"), 2, {"--studio"});
    words[5] = "5";
    expect_refused(with("1"), 2, {"--cameras", "too few for a studio"});
}

TEST_F(CliGpu, SkeletonShowDrawsJointsWhereTheyAre) {
    motion::SkeletonClip skeleton;
    skeleton.fps = double{kOwnFps};
    skeleton.frames.resize(4);
    for (motion::Pose& pose : skeleton.frames) {
        motion::at(pose, motion::Joint::kLeftElbow) = {{0.1, 0.2, 0}, 1, true};
        motion::at(pose, motion::Joint::kLeftWrist) = {{0.4, 0.3, 0.1}, 1, true};
    }
    motion::write_skeleton(file("scene.skeleton.glb"), skeleton);
    const ProgramResult result =
        run_neuvv({"skeleton", "show", scene, "-o", file("s.png"), "--frames", "1", "--size", "128x128"});
    ASSERT_EQ(result.code, 0) << result.err;
    const media::Image image = media::read_png(file("s.png"));
    const tools::ViewStep step =
        tools::orbit_path(voctree::occupied_box(tree), {{1, 1}, kOwnFps, kOwnFps}, {128, 128}).front();
    const glm::dvec2 wrist = *motion::project(step.camera, {0.4, 0.3, 0.1});
    const uint8_t* pixel = image.at(static_cast<uint32_t>(wrist.x), static_cast<uint32_t>(wrist.y));
    EXPECT_EQ((std::vector<int>{pixel[0], pixel[1], pixel[2]}), (std::vector<int>{60, 170, 255}));
    expect_refused({"skeleton", "show", scene, "-o", file("s.png"), "--skeleton", file("none.glb")}, 2, {"none.glb"});
}

}  // namespace
}  // namespace neuvv
