// Captures calibrated by COLMAP, in both file formats.
#include "training/data/layouts/loaders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "media/video.h"
#include "support/colmap_files.h"
#include "support/input_error.h"
#include "support/rig_pixel.h"
#include "training/data/layouts/formats.h"
#include "training/data/layouts/rig/camera_folders.h"

namespace neuvv {
namespace {

using test::ColmapSample;
using test::pixel_of;

// The camera models of COLMAP's documentation, each with its formula. u = x, v = y on the plane z = 1.
struct ModelCase {
    int id;
    const char* name;
    std::vector<double> parameters;
    std::function<glm::dvec2(const std::vector<double>&, double u, double v)> pixel;
};

// The direction times θ/r, and θ².
glm::dvec3 bent(double u, double v) {
    const double r = std::hypot(u, v), theta = std::atan(r);
    return {u * theta / r, v * theta / r, theta * theta};
}

using P = std::vector<double>;
const std::vector<ModelCase> kModelCases = {
    {0,
     "SIMPLE_PINHOLE",
     {90, 31, 22},
     [](const P& p, double u, double v) { return glm::dvec2(p[0] * u + p[1], p[0] * v + p[2]); }},
    {1,
     "PINHOLE",
     {90, 95, 31, 22},
     [](const P& p, double u, double v) { return glm::dvec2(p[0] * u + p[2], p[1] * v + p[3]); }},
    {2,
     "SIMPLE_RADIAL",
     {90, 31, 22, 0.1},
     [](const P& p, double u, double v) {
         const double d = 1 + p[3] * (u * u + v * v);
         return glm::dvec2(p[0] * d * u + p[1], p[0] * d * v + p[2]);
     }},
    {3,
     "RADIAL",
     {90, 31, 22, 0.1, -0.05},
     [](const P& p, double u, double v) {
         const double r2 = u * u + v * v, d = 1 + p[3] * r2 + p[4] * r2 * r2;
         return glm::dvec2(p[0] * d * u + p[1], p[0] * d * v + p[2]);
     }},
    {4,
     "OPENCV",
     {90, 95, 31, 22, 0.1, -0.05, 0.01, 0.02},
     [](const P& p, double u, double v) {
         const double r2 = u * u + v * v, d = 1 + p[4] * r2 + p[5] * r2 * r2;
         const double x = d * u + 2 * p[6] * u * v + p[7] * (r2 + 2 * u * u);
         const double y = d * v + 2 * p[7] * u * v + p[6] * (r2 + 2 * v * v);
         return glm::dvec2(p[0] * x + p[2], p[1] * y + p[3]);
     }},
    {5,
     "OPENCV_FISHEYE",
     {90, 95, 31, 22, 0.1, -0.05, 0.02, -0.01},
     [](const P& p, double u, double v) {
         const glm::dvec3 b = bent(u, v);
         const double t = b.z, d = 1 + p[4] * t + p[5] * t * t + p[6] * t * t * t + p[7] * t * t * t * t;
         return glm::dvec2(p[0] * d * b.x + p[2], p[1] * d * b.y + p[3]);
     }},
    {6,
     "FULL_OPENCV",
     {90, 95, 31, 22, 0.1, -0.05, 0.01, 0.02, 0.03, 0.04, -0.02, 0.01},
     [](const P& p, double u, double v) {
         const double r2 = u * u + v * v, r4 = r2 * r2, r6 = r4 * r2;
         const double d = (1 + p[4] * r2 + p[5] * r4 + p[8] * r6) / (1 + p[9] * r2 + p[10] * r4 + p[11] * r6);
         const double x = d * u + 2 * p[6] * u * v + p[7] * (r2 + 2 * u * u);
         const double y = d * v + 2 * p[7] * u * v + p[6] * (r2 + 2 * v * v);
         return glm::dvec2(p[0] * x + p[2], p[1] * y + p[3]);
     }},
    {7,
     "FOV",
     {90, 95, 31, 22, 0.9},
     [](const P& p, double u, double v) {
         const double r = std::hypot(u, v), d = std::atan(2 * r * std::tan(p[4] / 2)) / (p[4] * r);
         return glm::dvec2(p[0] * d * u + p[2], p[1] * d * v + p[3]);
     }},
    {8,
     "SIMPLE_RADIAL_FISHEYE",
     {90, 31, 22, 0.1},
     [](const P& p, double u, double v) {
         const glm::dvec3 b = bent(u, v);
         const double d = 1 + p[3] * b.z;
         return glm::dvec2(p[0] * d * b.x + p[1], p[0] * d * b.y + p[2]);
     }},
    {9,
     "RADIAL_FISHEYE",
     {90, 31, 22, 0.1, -0.05},
     [](const P& p, double u, double v) {
         const glm::dvec3 b = bent(u, v);
         const double d = 1 + p[3] * b.z + p[4] * b.z * b.z;
         return glm::dvec2(p[0] * d * b.x + p[1], p[0] * d * b.y + p[2]);
     }},
    {10,
     "THIN_PRISM_FISHEYE",
     {90, 95, 31, 22, 0.1, -0.05, 0.01, 0.02, 0.03, -0.01, 0.015, -0.02},
     [](const P& p, double u, double v) {
         const glm::dvec3 b = bent(u, v);
         const double t = b.z, d = 1 + p[4] * t + p[5] * t * t + p[8] * t * t * t + p[9] * t * t * t * t;
         const double x = d * b.x + 2 * p[6] * b.x * b.y + p[7] * (t + 2 * b.x * b.x) + p[10] * t;
         const double y = d * b.y + 2 * p[7] * b.x * b.y + p[6] * (t + 2 * b.y * b.y) + p[11] * t;
         return glm::dvec2(p[0] * x + p[2], p[1] * y + p[3]);
     }},
};

// The pose of camera i, which stands on a circle and is turned in some direction.
std::array<double, 7> pose_of(int i) {
    const glm::dquat q = glm::angleAxis(0.3 + 0.5 * i, glm::normalize(glm::dvec3(0.2, 1, -0.3 * i)));
    return {q.w, q.x, q.y, q.z, 0.1 * i, -0.2, 4.0 + i};
}

// Nine cameras with one image each, all of which have different lenses.
ColmapSample nine_cameras() {
    ColmapSample sample;
    for (int i = 0; i < 9; ++i) {
        const ModelCase& model = kModelCases[static_cast<size_t>(i)];
        sample.cameras.push_back({i + 1, model.id, model.name, 64, 48, model.parameters});
        sample.images.push_back({i + 1, pose_of(i), i + 1, fmt::format("cam{}.png", i)});
    }
    return sample;
}

struct ColmapTest : testing::TestWithParam<bool> {
    TemporaryFolder folder;
    ColmapSample sample = nine_cameras();

    std::filesystem::path model() const { return folder.path / "sparse" / "0"; }
    void write_images() const {
        for (const auto& image : sample.images) test::write_grey_png(folder.path / "images" / image.name, 64, 48);
    }
    training::Rig read(training::Split split = training::Split::kTrain) const {
        test::write_colmap(model(), sample, GetParam());
        return training::read_rig(folder.path, split);
    }
    void expect_bad(const std::function<void(ColmapSample&)>& damage, std::initializer_list<std::string> parts) {
        const ColmapSample good = sample;
        damage(sample);
        expect_input_error([&] { read(); }, parts);
        sample = good;
    }
};
INSTANTIATE_TEST_SUITE_P(Formats, ColmapTest, testing::Bool(),
                         [](const auto& which) { return which.param ? "Binary" : "Text"; });

TEST_P(ColmapTest, EveryModelPutsAPointWhereColmapDoes) {
    for (const ModelCase& model : kModelCases) {
        SCOPED_TRACE(model.name);
        sample.cameras = {{7, model.id, model.name, 64, 48, model.parameters}};
        sample.images = {{1, pose_of(1), 7, "a.png"}, {2, pose_of(2), 7, "b.png"}};
        write_images();
        const training::Rig rig = read();
        ASSERT_EQ(rig.cameras.size(), 1u);
        EXPECT_EQ(rig.cameras[0].name, "b");
        EXPECT_EQ(rig.cameras[0].lens.width, 64u);
        EXPECT_EQ(rig.cameras[0].lens.height, 48u);
        const std::array<double, 7> pose = pose_of(2);
        const glm::dquat rotation(pose[0], pose[1], pose[2], pose[3]);
        const glm::dvec3 in_camera(0.9, -0.6, 3);
        const glm::dvec3 world = glm::inverse(rotation) * (in_camera - glm::dvec3(pose[4], pose[5], pose[6]));
        const glm::dvec2 expected = model.pixel(model.parameters, 0.3, -0.2), found = pixel_of(rig.cameras[0], world);
        EXPECT_NEAR(found.x, expected.x, 1e-9);
        EXPECT_NEAR(found.y, expected.y, 1e-9);
        const glm::dmat3 axes(rig.cameras[0].world_from_camera);
        EXPECT_NEAR(glm::determinant(axes), 1, 1e-12);
    }
}

TEST_P(ColmapTest, EveryEighthImageIsHeldOut) {
    write_images();
    const training::Rig train = read(), test = read(training::Split::kTest);
    EXPECT_EQ(train.format, "colmap");
    ASSERT_EQ(train.cameras.size(), 7u);
    ASSERT_EQ(test.cameras.size(), 2u);
    EXPECT_EQ(test.cameras[0].name, "cam0");
    EXPECT_EQ(test.cameras[1].name, "cam8");
    EXPECT_EQ(train.shots.size(), 7u);
    EXPECT_EQ(train.shots[0].time, 0);
    EXPECT_EQ(train.shots[0].image.path, folder.path / "images" / "cam1.png");
    EXPECT_TRUE(train.shots[0].mask.path.empty());
    EXPECT_FALSE(train.box);
}

TEST_P(ColmapTest, TheModelMayStandElsewhere) {
    write_images();
    for (const char* model_path : {"sparse", "colmap/sparse/0", "."}) {
        test::write_colmap(folder.path / model_path, sample, GetParam());
        EXPECT_EQ(training::read_rig(folder.path, training::Split::kTrain).cameras.size(), 7u) << model_path;
        for (const char* file : {"cameras", "images"})
            for (const char* ending : {".bin", ".txt"})
                std::filesystem::remove(folder.path / model_path / (std::string(file) + ending));
    }
    expect_input_error([&] { training::read_rig(folder.path, training::Split::kTrain); },
                       {folder.path.string(), "sparse/0"});
    expect_input_error([&] { training::read_rig(folder.path, training::Split::kTrain, "colmap"); },
                       {"no sparse model"});
}

// One image of each camera is calibrated; the frames of its video lie in a folder.
TEST_P(ColmapTest, FoldersOfFramesAreVideosOfStillCameras) {
    sample.images.resize(3);
    for (int camera = 0; camera < 3; ++camera)
        for (int frame = 8; frame <= 11; ++frame) {
            if (camera == 1 && frame == 9) continue;  // a lost frame
            const std::string name = fmt::format("cam{}/{}.png", camera, frame);
            test::write_grey_png(folder.path / "images" / name, 64, 48);
            test::write_grey_png(folder.path / "masks" / name, 64, 48, 255);
        }
    const training::Rig train = read(), held_out = read(training::Split::kTest);
    ASSERT_EQ(train.cameras.size(), 2u);
    ASSERT_EQ(train.shots.size(), 3u + 4u);
    ASSERT_EQ(held_out.shots.size(), 4u);
    EXPECT_EQ(train.cameras[0].name, "cam1");
    EXPECT_EQ(train.masks, training::MaskMeaning::kMatte);
    const std::vector<double> times = {0, 2 / 3.0, 1};
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(train.shots[i].time, times[i], 1e-12);
    EXPECT_EQ(train.shots[0].image.path, folder.path / "images" / "cam1" / "8.png");
    EXPECT_EQ(train.shots[0].mask.path, folder.path / "masks" / "cam1" / "8.png");
    EXPECT_EQ(train.shots[2].name, "cam1_11");

    // The calibrated image may be one of the frames.
    for (auto& image : sample.images) image.name = image.name.substr(0, 4) + "/8.png";
    EXPECT_EQ(read().shots.size(), 7u);

    std::filesystem::remove(folder.path / "masks" / "cam1" / "11.png");
    expect_input_error([&] { read(); }, {"cam1", "11.png", "mask"});
}

TEST_P(ColmapTest, VideosOfCameras) {
    sample.images.resize(2);
    for (int camera = 0; camera < 2; ++camera)
        for (const char* kind : {"videos", "masks"}) {
            std::filesystem::create_directories(folder.path / kind);
            media::VideoWriter video(folder.path / kind / fmt::format("cam{}.mp4", camera), 64, 48, 10);
            for (int frame = 0; frame < 3; ++frame) video.add(media::Image(64, 48));
            video.finish();
        }
    const training::Rig rig = read();
    ASSERT_EQ(rig.shots.size(), 3u);
    EXPECT_EQ(rig.fps, 10);
    EXPECT_EQ(rig.shots[2].image.path, folder.path / "videos" / "cam1.mp4");
    EXPECT_EQ(rig.shots[2].image.video_frame, 2);
    EXPECT_EQ(rig.shots[2].mask.path, folder.path / "masks" / "cam1.mp4");
    EXPECT_EQ(rig.shots[1].time, 0.5);
}

// Where every frame is calibrated, the camera moves.
TEST_P(ColmapTest, ImagesOfAFolderAreHeldOutTogether) {
    sample.images.clear();
    for (int i = 0; i < 6; ++i)
        sample.images.push_back({i, pose_of(i), 2, fmt::format("rig/{}/f{:02}.png", i / 3, 5 * (i % 3))});
    write_images();
    const training::Rig rig = read(), held_out = read(training::Split::kTest);
    ASSERT_EQ(rig.cameras.size(), 3u);
    ASSERT_EQ(held_out.cameras.size(), 3u);
    EXPECT_EQ(rig.cameras[1].name, "rig/1/f05");
    EXPECT_EQ(rig.shots[1].time, 0.5);
    EXPECT_EQ(held_out.shots[2].time, 1);
}

TEST_P(ColmapTest, TheBoxLeavesStraysOut) {
    write_images();
    for (int i = 0; i < 1000; ++i) sample.points.push_back({i / 1000.0, 2 + i / 500.0, -(i % 100) / 100.0});
    for (const double stray : {-500.0, 500.0, 1e300, std::numeric_limits<double>::infinity()})
        sample.points.push_back({stray, stray, stray});
    if (!GetParam()) sample.points.pop_back();  // text cannot express infinity
    const training::Rig rig = read();
    ASSERT_TRUE(rig.box);
    EXPECT_NEAR(rig.box->first.x, -0.5, 0.05);
    EXPECT_NEAR(rig.box->second.x, 1.5, 0.05);
    EXPECT_NEAR(rig.box->first.y, 1, 0.1);
    EXPECT_NEAR(rig.box->second.y, 5, 0.1);
}

TEST_P(ColmapTest, DamageIsNamed) {
    write_images();
    const char* images = GetParam() ? "images.bin" : "images.txt";
    const char* cameras = GetParam() ? "cameras.bin" : "cameras.txt";
    const double nan = std::nan("");
    expect_bad([](auto& s) { s.images.clear(); }, {images, "no image"});
    expect_bad([](auto& s) { s.images.resize(1); }, {images, "one camera"});
    expect_bad([](auto& s) { s.images[2].camera = 77; }, {images, "77"});
    expect_bad([](auto& s) { s.images[2].name = "../../secret.png"; }, {images, "secret.png", "folder"});
    expect_bad([](auto& s) { s.images[2].name = "/etc/passwd"; }, {images, "passwd", "folder"});
    expect_bad([](auto& s) { s.images[2].name = s.images[1].name; }, {images, "cam1.png"});
    expect_bad([](auto& s) { s.images[2].name = "lost.png"; }, {images, "lost.png", "no image"});
    expect_bad([](auto& s) { s.images[2].pose = {0, 0, 0, 0, 1, 2, 3}; }, {images, "quaternion"});
    expect_bad([](auto& s) { s.images[2].pose[5] = 1e9; }, {images, "origin"});
    expect_bad([&](auto& s) { s.images[2].pose[5] = nan; }, {images});
    expect_bad([](auto& s) { s.cameras[3].model = 11, s.cameras[3].model_name = "ORB"; }, {cameras, "unknown camera"});
    expect_bad([](auto& s) { s.cameras[3].id = 1; }, {cameras, "id 1"});
    expect_bad([](auto& s) { s.cameras[3].width = 0; }, {images, "width 0"});
    expect_bad([](auto& s) { s.cameras[3].height = 0; }, {images, "64×0"});
    expect_bad([](auto& s) { s.cameras[3].width = uint64_t{1} << 40; }, {images, "pixels"});
    expect_bad([](auto& s) { s.cameras[3].parameters[0] = 0; }, {images, "focal"});
    expect_bad([&](auto& s) { s.cameras[3].parameters[4] = nan; }, {"distortion"});
    std::filesystem::create_directories(folder.path / "masks");
    expect_bad([](auto&) {}, {"masks", "cam0.png.png"});
}

TEST_P(ColmapTest, TruncatedAnywhereIsNeverSilent) {
    write_images();
    sample.points.assign(120, {1, 2, 3});
    read();
    for (const char* stem : {"cameras", "images", "points3D"}) {
        const auto file = model() / (std::string(stem) + (GetParam() ? ".bin" : ".txt"));
        const std::string whole = read_text(file);
        for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 200) {
            write_text(file, whole.substr(0, length));
            if (GetParam())
                expect_input_error([&] { training::read_rig(folder.path, training::Split::kTrain); }, {stem});
            else  // a text may end after any of its lines
                try {
                    EXPECT_LE(training::read_rig(folder.path, training::Split::kTrain).cameras.size(), 7u);
                } catch (const InputError&) {
                }
        }
        write_text(file, whole);
    }
}

struct ColmapBinary : ColmapTest {};
INSTANTIATE_TEST_SUITE_P(Formats, ColmapBinary, testing::Values(true));

// A count in the file must be checked against the file's size before memory is allocated.
TEST_P(ColmapBinary, CountsBeyondTheFile) {
    write_images();
    sample.points.assign(120, {1, 2, 3});
    read();
    for (const char* stem : {"cameras", "images", "points3D"}) {
        const auto file = model() / (std::string(stem) + ".bin");
        const std::string whole = read_text(file);
        for (const uint64_t count : {uint64_t{1000}, uint64_t{1} << 32, uint64_t{1} << 61, UINT64_MAX}) {
            std::string damaged;
            test::append(damaged, count);
            write_text(file, damaged + whole.substr(8));
            expect_input_error([&] { training::read_rig(folder.path, training::Split::kTrain); },
                               {stem, fmt::format("{}", count)});
        }
        write_text(file, whole);
    }
}

TEST(ColmapText, NamesMayHoldSpacesAndLinesEndInWindows) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path / "images");
    write_text(folder.path / "sparse/cameras.txt", "# comment\r\n1 PINHOLE 8 6 9 9 4 3\r\n");
    write_text(folder.path / "sparse/images.txt",
               "1 1 0 0 0 0 0 0 1 a b.png \r\n\r\n2 1 0 0 0 1 0 0 1 c.png\r\n0 0 -1\r\n");
    for (const char* name : {"a b.png", "c.png"}) test::write_grey_png(folder.path / "images" / name, 8, 6);
    EXPECT_EQ(training::read_rig(folder.path, training::Split::kTest).cameras.at(0).name, "a b");
    write_text(folder.path / "sparse/cameras.txt", "1 PINHOLE 8 6 9 nine 4 3\n");
    expect_input_error([&] { training::read_rig(folder.path, training::Split::kTest); },
                       {"cameras.txt", "line 1", "nine"});
    write_text(folder.path / "sparse/cameras.txt", "1 PINHOLE 8 6 9 9 4\n");
    expect_input_error([&] { training::read_rig(folder.path, training::Split::kTest); },
                       {"cameras.txt", "line 1", "parameter"});
}

TEST(NaturalOrderTest, NumbersCountByTheirValue) {
    const training::NaturalOrder less;
    const std::vector<std::string> ordered = {"", "01", "1", "2", "10", "a1b2", "a1b10", "a2", "f9", "f10", "f10a"};
    for (size_t i = 0; i < ordered.size(); ++i)
        for (size_t j = 0; j < ordered.size(); ++j) EXPECT_EQ(less(ordered[i], ordered[j]), i < j) << i << " " << j;
}

}  // namespace
}  // namespace neuvv
