#include "training/capture/capture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/platform.h"
#include "media/psnr.h"
#include "motion/skeleton/skeleton_file.h"
#include "stage/pose.h"
#include "tests/stage/glb_builder.h"
#include "tests/support/input_error.h"
#include "tests/support/near.h"
#include "tests/support/temporary_folder.h"
#include "training/data/dataset.h"
#include "training/mattes/make_mattes.h"

namespace neuvv {
namespace {

const std::filesystem::path kPerformer = NEUVV_SOURCE_DIR "/tools/performer/performer.glb";

const gpu::Device& device() {
    static const gpu::Device shared("", gpu::Validation::kOn);
    return shared;
}

training::CaptureSettings small_settings() {
    training::CaptureSettings settings;
    settings.cameras = 6;
    settings.frames = 3;
    settings.fps = 1;
    settings.width = 64;
    settings.height = 72;
    settings.holdout = 0.3;
    return settings;
}

training::CaptureResult run(const std::filesystem::path& folder, const training::CaptureSettings& settings,
                            const std::filesystem::path& model = kPerformer) {
    const training::CaptureResult result = training::capture(device(), model, folder, settings, nullptr);
    EXPECT_EQ(device().drain_validation_messages(), std::vector<std::string>());
    return result;
}

glm::dvec2 project(const stage::Camera& camera, const glm::vec3& point) {
    const glm::dvec3 p(glm::inverse(camera.world_from_camera) * glm::dvec4(point, 1));
    return {camera.cx - camera.fx * p.x / p.z, camera.cy + camera.fy * p.y / p.z};
}

// The largest alpha in the 3 × 3 pixels around a position in the image.
int alpha_near(const training::TiledImage& image, const glm::dvec2& pixel) {
    int largest = 0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const auto x = static_cast<uint32_t>(
                std::clamp<int>(static_cast<int>(pixel.x) + dx, 0, static_cast<int>(image.width()) - 1));
            const auto y = static_cast<uint32_t>(
                std::clamp<int>(static_cast<int>(pixel.y) + dy, 0, static_cast<int>(image.height()) - 1));
            largest = std::max(largest, int{image.at(x, y)[3]});
        }
    return largest;
}

// Expects that every vertex projects onto the silhouette, and that the silhouette ends where the vertices do.
void expect_silhouette(const training::View& view, const stage::Camera& camera, const std::vector<glm::vec3>& points) {
    glm::dvec2 low(1e9), high(-1e9), alpha_low(1e9), alpha_high(-1e9);
    int missed = 0;
    for (const glm::vec3& point : points) {
        const glm::dvec2 pixel = project(camera, point);
        low = glm::min(low, pixel);
        high = glm::max(high, pixel);
        missed += alpha_near(view.image, pixel) == 0;
    }
    EXPECT_EQ(missed, 0) << view.name;
    EXPECT_GT(std::min(low.x, low.y), 1) << view.name;
    EXPECT_LT(high.x, camera.width - 1.0) << view.name;
    EXPECT_LT(high.y, camera.height - 1.0) << view.name;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x)
            if (view.image.at(x, y)[3] > 0) {
                alpha_low = glm::min(alpha_low, glm::dvec2(x, y));
                alpha_high = glm::max(alpha_high, glm::dvec2(x + 1.0, y + 1.0));
            }
    EXPECT_LT(glm::length(alpha_low - low) + glm::length(alpha_high - high), 4) << view.name;
}

TEST(Capture, DataSetMatchesTheModel) {
    const TemporaryFolder folder;
    const training::CaptureSettings settings = small_settings();
    const training::CaptureResult result = run(folder.path, settings);
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.train_cameras, 4u);
    EXPECT_EQ(result.test_cameras, 2u);
    const training::Dataset train = training::load_dataset(folder.path, training::Split::kTrain),
                            test = training::load_dataset(folder.path, training::Split::kTest);
    EXPECT_EQ(train.cameras.size(), 4u);
    EXPECT_EQ(train.views.size(), 12u);
    EXPECT_EQ(test.views.size(), 6u);
    EXPECT_EQ(train.times, (std::vector<double>{0, 0.5, 1}));
    EXPECT_EQ(train.fps, 1);
    EXPECT_EQ(train.plates.at(0).width, 0u);

    const stage::GltfScene scene = stage::load_gltf(kPerformer);
    const auto [low, high] = stage::bounds_over(scene, 0, {0, 1, 2});
    ASSERT_TRUE(train.box);
    for (int i = 0; i < 3; ++i) {
        EXPECT_LT(train.box->first[i], low[i]);
        EXPECT_GT(train.box->second[i], high[i]);
        EXPECT_LT(train.box->second[i] - train.box->first[i], (high[i] - low[i]) * 1.2);
    }
    const auto node = static_cast<uint32_t>(scene.nodes.size() - 1);
    for (const training::Dataset* set : {&train, &test})
        for (const training::View& view : set->views) {
            stage::PosedVertices vertices;
            stage::pose_vertices(scene, stage::pose_scene(scene, 0, view.time * 2), node, scene.meshes[0].primitives[0],
                                 vertices);
            expect_silhouette(view, set->cameras[view.camera], vertices.positions);
        }
}

TEST(Capture, CheckerIsTheSamePerformerOverThePlate) {
    const TemporaryFolder clear_folder, checker_folder;
    training::CaptureSettings settings = small_settings();
    settings.frames = 2;
    run(clear_folder.path, settings);
    settings.background = training::CaptureBackground::kChecker;
    run(checker_folder.path, settings);
    const training::Dataset clear = training::load_dataset(clear_folder.path, training::Split::kTrain);
    const training::Dataset checker = training::load_dataset(checker_folder.path, training::Split::kTrain);
    double worst = 0;
    for (size_t v = 0; v < clear.views.size(); ++v) {
        const media::Image image = media::read_png(checker_folder.path / "images" / (checker.views[v].name + ".png"));
        const media::Image& plate = checker.plates.at(checker.views[v].camera);
        ASSERT_EQ(plate.width, image.width);
        EXPECT_NE(std::equal(plate.rgba.begin() + 4, plate.rgba.end(), plate.rgba.begin()), true) << "one colour only";
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x) {
                ASSERT_EQ(image.at(x, y)[3], clear.views[v].image.at(x, y)[3]);
                if (image.at(x, y)[3] == 0) {
                    for (int c = 0; c < 3; ++c) ASSERT_EQ(image.at(x, y)[c], plate.at(x, y)[c]);
                }
                const glm::vec4 difference = training::foreground(clear, clear.views[v], x, y) -
                                             training::foreground(checker, checker.views[v], x, y);
                for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(static_cast<double>(difference[c])));
            }
    }
    EXPECT_LT(worst, 0.012) << "8-bit rounding of image, plate and matte, in linear light";
}

TEST(Capture, AStoppedCaptureLeavesNoTransforms) {
    const TemporaryFolder folder;
    write_text(folder.path / "transforms_train.json", "of an older capture");
    const training::CaptureResult result = training::capture(device(), kPerformer, folder.path, small_settings(),
                                                             [](uint64_t done, uint64_t) { return done < 2; });
    EXPECT_FALSE(result.complete);
    EXPECT_FALSE(std::filesystem::exists(folder.path / "transforms_train.json"));
    EXPECT_FALSE(std::filesystem::exists(folder.path / "transforms_test.json"));
    EXPECT_EQ(device().drain_validation_messages(), std::vector<std::string>());
}

TEST(Capture, WritesTheModelsJoints) {
    const TemporaryFolder folder;
    EXPECT_EQ(run(folder.path, small_settings()).no_skeleton, "");
    const motion::SkeletonClip clip = motion::read_skeleton(folder.path / training::kTrueSkeleton);
    EXPECT_DOUBLE_EQ(clip.fps, 1);
    ASSERT_EQ(clip.frames.size(), 3u);
    const stage::GltfScene scene = stage::load_gltf(kPerformer);
    for (size_t f = 0; f < 3; ++f) {
        const stage::PosedScene pose = stage::pose_scene(scene, 0, static_cast<double>(f));
        const auto place = [&](const std::string& name) {
            const auto node = std::ranges::find(scene.nodes, name, &stage::GltfNode::name) - scene.nodes.begin();
            return glm::dvec3(pose.world_from_node[static_cast<size_t>(node)][3]);
        };
        test::expect_near(motion::at(clip.frames[f], motion::Joint::kLeftWrist).position, place("left_hand"), 1e-5);
        test::expect_near(motion::at(clip.frames[f], motion::Joint::kRightKnee).position, place("right_shin"), 1e-5);
    }
}

TEST(Capture, AModelWithoutAnimationShowsItsRestPose) {
    test::GlbBuilder glb;
    glb.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", glb.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}}}}}};
    glb.root["nodes"] = {{{"mesh", 0}}};
    glb.root["materials"] = {{{"doubleSided", true}}};
    glb.root["meshes"][0]["primitives"][0]["material"] = 0;
    const TemporaryFolder model;
    const TemporaryFolder folder;
    training::CaptureSettings settings = small_settings();
    settings.frames = 2;
    settings.holdout = 0;
    run(folder.path, settings, model.write(glb.bytes()));
    EXPECT_FALSE(std::filesystem::exists(folder.path / "transforms_test.json"));
    const training::Dataset dataset = training::load_dataset(folder.path, training::Split::kTrain);
    ASSERT_EQ(dataset.views.size(), 12u);
    EXPECT_EQ(dataset.views[0].image, dataset.views[1].image);
}

TEST(Capture, BadSettingsAreNamed) {
    const TemporaryFolder folder;
    const auto refuse = [&](const std::function<void(training::CaptureSettings&)>& change, const std::string& name) {
        training::CaptureSettings settings = small_settings();
        change(settings);
        expect_input_error([&] { run(folder.path, settings); }, {name});
    };
    refuse([](auto& s) { s.cameras = 0; }, "cameras: ");
    refuse([](auto& s) { s.frames = 0; }, "frames: ");
    refuse([](auto& s) { s.frames = 4000000000u; }, "frames: ");
    refuse([](auto& s) { s.fps = NAN; }, "fps: ");
    refuse([](auto& s) { s.fps = 0; }, "fps: ");
    refuse([](auto& s) { s.width = 7; }, "size: ");
    refuse([](auto& s) { s.height = 100000; }, "size: ");
    refuse(
        [](auto& s) {
            s.videos = true;
            s.width = 65;
        },
        "size: 65x72 has an odd side");
    refuse([](auto& s) { s.holdout = NAN; }, "holdout: ");
    refuse([](auto& s) { s.holdout = 1; }, "holdout: ");
    refuse([](auto& s) { s.cameras = 1; }, "holdout: ");
    refuse([](auto& s) { s.holdout = 0.9; }, "holdout: 0.9 leaves one of 6 cameras to train with");
    refuse([](auto& s) { s.animation = "waltz"; }, "dance");
    EXPECT_EQ(folder.entries(), 0u) << "refused before anything is written";
    expect_input_error([&] { run(folder.path, small_settings(), folder.path / "none.glb"); }, {"none.glb"});
}

TEST(Performer, StandsOnTheFloorAndMoves) {
    const stage::GltfScene scene = stage::load_gltf(kPerformer);
    ASSERT_EQ(stage::find_animation(scene, "dance"), 0u);
    EXPECT_NEAR(scene.animations[0].duration_s, 3, 1e-6);
    const auto [low, high] = stage::bounds_over(scene, stage::kNoAnimation, {0});
    EXPECT_NEAR(low.y, 0, 0.01);
    EXPECT_NEAR(high.y, 1.72, 0.05);
    std::vector<double> times;
    for (int f = 0; f < 75; ++f) times.push_back(f / 25.0);
    const auto moving = stage::bounds_over(scene, 0, times);
    EXPECT_GT(moving.first.y, -0.03) << "no foot sinks into the floor";
    EXPECT_GT(moving.second.y, 1.8) << "arms rise above the head";
    EXPECT_GT(moving.second.x - moving.first.x, 1.5);
    EXPECT_LT(moving.second.x - moving.first.x, 2.5);
    const glm::dvec3 start = stage::pose_scene(scene, 0, 0).world_from_node[0][3],
                     end = stage::pose_scene(scene, 0, 3).world_from_node[0][3];
    EXPECT_LT(glm::length(start - end), 1e-5) << "the end joins the start";
}

TEST(Performer, TheScriptMakesTheFile) {
    if (std::system("python3 -c 'import zlib' > /dev/null 2>&1") != 0) GTEST_SKIP() << "python3 is not installed";
    const TemporaryFolder folder;
    const auto made = folder.path / "performer.glb";
    const std::string command =
        "python3 '" NEUVV_SOURCE_DIR "/tools/performer/make_performer.py' '" + made.string() + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_TRUE(read_file(made) == read_file(kPerformer))
        << "run tools/performer/make_performer.py and commit the result";
    EXPECT_LT(std::filesystem::file_size(kPerformer), 1500000u);
}

// The mattes that `neuvv matte` finds in a captured room, against those of the capture.
TEST(Capture, MattesAreFoundInTheCheckeredRoom) {
    const TemporaryFolder folder;
    training::CaptureSettings settings = small_settings();
    settings.width = settings.height = 160;
    settings.background = training::CaptureBackground::kChecker;
    run(folder.path, settings);
    const training::Dataset truth = training::load_dataset(folder.path, training::Split::kTrain);
    std::filesystem::create_directories(folder.path / "mattes");
    const training::MatteSummary summary =
        training::make_mattes({.dataset = folder.path, .output = folder.path / "mattes"}, {});
    EXPECT_EQ(summary.images, 18u);
    EXPECT_EQ(summary.cameras_with_plate, 6u);
    EXPECT_EQ(summary.missing_split, "");
    const training::Dataset found = training::load_dataset(folder.path, training::Split::kTrain);
    double both = 0, either = 0, error = 0, pixels = 0;
    for (size_t i = 0; i < truth.views.size(); ++i) {
        const media::Image true_image = truth.views[i].image.whole(), image = found.views[i].image.whole();
        for (size_t k = 3; k < image.rgba.size(); k += 4) {
            const int a = true_image.rgba[k], b = image.rgba[k];
            both += a > 127 && b > 127;
            either += a > 127 || b > 127;
            error += std::abs(a - b) / 255.0;
            ++pixels;
        }
    }
    EXPECT_GT(both / either, 0.95);
    EXPECT_LT(error / pixels, 0.005);
    RecordProperty("iou", std::to_string(both / either));
    RecordProperty("mae", std::to_string(error / pixels));
}

TEST(Capture, VideosShowWhatTheImagesDoAndHaveNoMattes) {
    const TemporaryFolder folder;
    training::CaptureSettings settings = small_settings();
    settings.background = training::CaptureBackground::kChecker;
    run(folder.path / "images", settings);
    settings.videos = true;
    run(folder.path / "videos", settings);
    EXPECT_FALSE(std::filesystem::exists(folder.path / "videos/images"));
    EXPECT_FALSE(std::filesystem::exists(folder.path / "videos/mattes"));
    for (const training::Split split : {training::Split::kTrain, training::Split::kTest}) {
        const training::Dataset images = training::load_dataset(folder.path / "images", split);
        const training::Dataset videos =
            training::load_dataset(folder.path / "videos", split, {.mattes_needed = false});
        ASSERT_EQ(videos.cameras.size(), images.cameras.size());
        EXPECT_DOUBLE_EQ(videos.fps, settings.fps);
        ASSERT_EQ(videos.views.size(), images.views.size());
        for (size_t i = 0; i < images.views.size(); ++i) {
            const training::View &video = videos.views[i], &image = images.views[i];
            EXPECT_EQ(videos.cameras[video.camera].world_from_camera, images.cameras[image.camera].world_from_camera);
            EXPECT_DOUBLE_EQ(video.time, image.time);
            const media::Image shown = video.image.whole();
            const media::Image file = media::read_png(folder.path / "images/images" / (image.name + ".png"));
            EXPECT_GT(media::psnr_db(file, shown), 25) << video.name;
            for (size_t k = 3; k < shown.rgba.size(); k += 4) ASSERT_EQ(shown.rgba[k], 255) << "a matte";
        }
        for (size_t c = 0; c < images.plates.size(); ++c) EXPECT_EQ(videos.plates[c].rgba, images.plates[c].rgba);
    }
}

}  // namespace
}  // namespace neuvv
