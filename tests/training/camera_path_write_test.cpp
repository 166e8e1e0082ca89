// Camera paths for other programs: a known point is seen where those programs' own rules say, and our readers give the
// same images back.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/error.h"
#include "fuzz/mutate.h"
#include "interchange/camera/camera_path_file.h"
#include "interchange/stage/camera_gltf.h"
#include "interchange/stage/camera_usd.h"
#include "interchange/usd/usd_text.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

using nlohmann::json;

constexpr uint32_t kPathWidth = 320, kPathHeight = 180;
constexpr double kFps = 10, kOneDegree = std::numbers::pi / 180;
const glm::dvec3 kPoint(0.3, 1.2, -0.4);

// Three keys around the point, with other angles, tilts and heights.
stage::CameraPath keys_around(bool cyclic = false) {
    stage::CameraPath path;
    for (int i = 0; i < 3; ++i) {
        stage::CameraPathKey key;
        key.time_s = 0.7 * i;
        key.world_from_camera = glm::angleAxis((20.0 + 40 * i) * kOneDegree, glm::dvec3(0, 1, 0)) *
                                glm::angleAxis(-10 * kOneDegree * i, glm::dvec3(1, 0, 0)) *
                                glm::angleAxis(5 * kOneDegree * i, glm::dvec3(0, 0, 1));
        key.position = kPoint + key.world_from_camera * glm::dvec3(0.2, -0.1, 3 + i);
        key.angle_y = (40.0 + 5 * i) * kOneDegree;
        path.keys.push_back(key);
    }
    path.cyclic = cyclic;
    path.duration_s = cyclic ? 2.0 : 1.4;
    return path;
}

// Pixels of a point that lies at `camera` in axes that look along −Z with +Y up, by a focal length in pixels.
glm::dvec2 pixel_of(const glm::dvec3& camera, double focal) {
    return {0.5 * kPathWidth - focal * camera.x / camera.z, 0.5 * kPathHeight + focal * camera.y / camera.z};
}

glm::dvec2 expected_pixel(const stage::CameraPath& path, double time_s) {
    const stage::Camera camera = stage::camera_at(path, time_s, kPathWidth, kPathHeight);
    return pixel_of(glm::dvec3(glm::inverse(camera.world_from_camera) * glm::dvec4(kPoint, 1)), camera.fy);
}

void expect_pixel(const stage::CameraPath& path, size_t image, const glm::dvec2& pixel, double tolerance = 1e-6) {
    const glm::dvec2 expected = expected_pixel(path, static_cast<double>(image) / kFps);
    EXPECT_LT(glm::distance(pixel, expected), tolerance)
        << image << ": " << pixel.x << " " << pixel.y << ", not " << expected.x << " " << expected.y;
}

double focal_of(double fov_degrees) {
    return 0.5 * kPathHeight / std::tan(0.5 * fov_degrees * kOneDegree);
}

struct CameraPathWrite : testing::Test {
    TemporaryFolder folder;
    stage::CameraPath path = keys_around();
    stage::CameraPath images = stage::by_images(path, kFps, kPathWidth, kPathHeight);

    std::filesystem::path file(const std::string& name) const { return folder.path / name; }
    json read(const std::string& name) const { return json::parse(read_text(file(name))); }
    // Expects that the file's images are those of the path.
    void expect_read_back(const std::string& name, double tolerance, bool angles = true) {
        const stage::CameraPath back = interchange::read_camera_path(file(name), kFps);
        ASSERT_EQ(back.keys.size(), images.keys.size());
        EXPECT_EQ(back.cyclic, images.cyclic);
        EXPECT_NEAR(back.duration_s, images.duration_s, tolerance);
        for (size_t i = 0; i < images.keys.size(); ++i) {
            const stage::CameraPathKey &a = back.keys[i], &b = images.keys[i];
            EXPECT_NEAR(a.time_s, b.time_s, tolerance);
            EXPECT_LT(glm::distance(a.position, b.position), tolerance) << i;
            EXPECT_NEAR(std::abs(glm::dot(a.world_from_camera, b.world_from_camera)), 1, tolerance) << i;
            if (angles) {
                EXPECT_NEAR(a.angle_y, b.angle_y, tolerance) << i;
            }
            EXPECT_EQ(a.stretch, 1);
        }
    }
};

TEST_F(CameraPathWrite, ImagesAreThoseOfThePath) {
    ASSERT_EQ(images.keys.size(), 15u);
    for (size_t i = 0; i < 15; ++i) expect_pixel(path, i, expected_pixel(images, static_cast<double>(i) / kFps), 1e-9);
    EXPECT_EQ(images.duration_s, 1.4);
    const stage::CameraPath cycle = stage::by_images(keys_around(true), kFps, kPathWidth, kPathHeight);
    EXPECT_EQ(cycle.keys.size(), 20u) << "the last image is not the first again";
    EXPECT_EQ(cycle.duration_s, 2);
    path.duration_s = 1e6;
    path.cyclic = true;
    expect_input_error([&] { stage::by_images(path, kFps, kPathWidth, kPathHeight); }, {"more than 65536 images"});
}

// nerfstudio: rows of camera to world with OpenGL axes, the vertical angle of view in degrees, a world with +Z up.
TEST_F(CameraPathWrite, Nerfstudio) {
    interchange::write_nerfstudio_path(file("path.json"), path, images, {});
    const json written = read("path.json");
    EXPECT_EQ(written["render_width"], kPathWidth);
    EXPECT_EQ(written["render_height"], kPathHeight);
    EXPECT_EQ(written["fps"], kFps);
    EXPECT_EQ(written["seconds"], 1.5) << "nerfstudio renders fps · seconds images";
    EXPECT_EQ(written["keyframes"].size(), 3u);
    EXPECT_NEAR(written["keyframes"][2]["override_transition_sec"], 0.7, 1e-9);
    ASSERT_EQ(written["camera_path"].size(), images.keys.size());
    for (size_t i = 0; i < images.keys.size(); ++i) {
        const json& image = written["camera_path"][i];
        glm::dmat4 c2w;
        for (int k = 0; k < 16; ++k) c2w[k % 4][k / 4] = image["camera_to_world"][static_cast<size_t>(k)];
        const glm::dvec4 point(kPoint.x, -kPoint.z, kPoint.y, 1);
        expect_pixel(path, i, pixel_of(glm::dvec3(glm::inverse(c2w) * point), focal_of(image["fov"])));
        EXPECT_NEAR(image["aspect"], 16.0 / 9, 1e-9);
    }
    expect_read_back("path.json", 1e-9);
}

TEST_F(CameraPathWrite, NerfstudiosParsedWorldIsReached) {
    // A turn by 90° about z, a shift, and half the size.
    write_text(file("dataparser_transforms.json"),
               R"({"transform": [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]], "scale": 0.5})");
    interchange::write_nerfstudio_path(file("path.json"), path, images, file("dataparser_transforms.json"));
    const json c2w = read("path.json")["camera_path"][0]["camera_to_world"];
    const glm::dvec3 p = images.keys[0].position, q(p.x, -p.z, p.y);
    EXPECT_NEAR(c2w[3], 0.5 * (-q.y + 1), 1e-9);
    EXPECT_NEAR(c2w[7], 0.5 * (q.x + 2), 1e-9);
    EXPECT_NEAR(c2w[11], 0.5 * (q.z + 3), 1e-9);
    expect_read_back("path.json", 1e-9);
}

TEST_F(CameraPathWrite, NerfstudiosAppliedTransformIsUndoneFirst) {
    // (x, y, z) became (x, z, −y) when the data set was made; the data parser's transform is of what was before.
    write_text(file("world.json"),
               R"({"transform": [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7]],
                   "applied_transform": [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0]]})");
    interchange::write_nerfstudio_path(file("path.json"), path, images, file("world.json"));
    const json c2w = read("path.json")["camera_path"][0]["camera_to_world"];
    const glm::dvec3 p = images.keys[0].position, q(p.x, -p.z, p.y);
    EXPECT_NEAR(c2w[3], q.x + 5, 1e-9);
    EXPECT_NEAR(c2w[7], -q.z + 6, 1e-9);
    EXPECT_NEAR(c2w[11], q.y + 7, 1e-9);
    expect_read_back("path.json", 1e-9);
}

TEST_F(CameraPathWrite, NerfstudioCyclesAndShowsTheClip) {
    path = keys_around(true);
    for (stage::CameraPathKey& key : path.keys) key.clip_time = key.time_s / 2;
    images = stage::by_images(path, kFps, kPathWidth, kPathHeight);
    interchange::write_nerfstudio_path(file("path.json"), path, images, {});
    const json written = read("path.json");
    EXPECT_EQ(written["is_cycle"], true);
    EXPECT_NEAR(written["keyframes"][0]["override_transition_sec"], 0.6, 1e-9) << "from the last key to the first";
    EXPECT_NEAR(written["camera_path"][7]["render_time"], 0.35, 1e-9);
    expect_read_back("path.json", 1e-9);
}

// instant-ngp: R and T take OpenCV axes (x right, y down, z forward) to its cube; fov is vertical, in degrees; a key's
// timestamp is the time of the next one.
TEST_F(CameraPathWrite, InstantNgp) {
    write_text(file("transforms.json"), R"({"scale": 0.25, "offset": [0.5, 0.25, 0.75]})");
    for (const bool trained : {false, true}) {
        const double scale = trained ? 0.25 : 0.33;
        const glm::dvec3 offset = trained ? glm::dvec3(0.5, 0.25, 0.75) : glm::dvec3(0.5);
        interchange::write_ngp_path(file("path.json"), images, trained ? file("transforms.json") : "");
        const json written = read("path.json");
        EXPECT_EQ(written["spline_order"], 1);
        EXPECT_EQ(written["loop"], false);
        EXPECT_NEAR(written["duration_seconds"], 1.4, 1e-12);
        ASSERT_EQ(written["path"].size(), images.keys.size());
        for (size_t i = 0; i < images.keys.size(); ++i) {
            const json& key = written["path"][i];
            const glm::dquat r(key["R"][3], key["R"][0], key["R"][1], key["R"][2]);
            const glm::dvec3 t(key["T"][0], key["T"][1], key["T"][2]);
            const glm::dvec3 point = glm::dvec3(kPoint.x, -kPoint.z, kPoint.y) * scale + offset;
            const glm::dvec3 seen = glm::conjugate(r) * (glm::dvec3(point.y, point.z, point.x) - t);
            expect_pixel(path, i, pixel_of({seen.x, -seen.y, -seen.z}, focal_of(key["fov"])));
            EXPECT_NEAR(key["timestamp"], static_cast<double>(i + 1) / kFps, 1e-9);
        }
        expect_read_back("path.json", 1e-9);
    }
    images = stage::by_images(keys_around(true), kFps, kPathWidth, kPathHeight);
    interchange::write_ngp_path(file("loop.json"), images, {});
    EXPECT_NEAR(read("loop.json")["path"].back()["timestamp"], 2, 1e-9);
    expect_read_back("loop.json", 1e-9);
}

TEST_F(CameraPathWrite, Gltf) {
    interchange::write_camera_glb(file("path.glb"), images);
    expect_read_back("path.glb", 1e-5, false);
    const stage::CameraPath back = interchange::read_camera_path(file("path.glb"), kFps);
    EXPECT_NEAR(back.keys[7].angle_y, path.keys[0].angle_y, 1e-9) << "glTF has one angle";
    // A camera that stands still is one without an animation.
    path.keys.resize(1);
    path.duration_s = 0;
    images = stage::by_images(path, kFps, kPathWidth, kPathHeight);
    interchange::write_camera_glb(file("still.glb"), images);
    expect_read_back("still.glb", 1e-6);
}

// OpenUSD: the window through which the lens looks, at the focal length, is as large as the sensor and moved by the
// offsets; the camera looks along −Z with +Y up.
TEST_F(CameraPathWrite, Usd) {
    for (stage::CameraPathKey& key : path.keys) key.shift = {0.1, -0.05};
    images = stage::by_images(path, kFps, kPathWidth, kPathHeight);
    interchange::write_camera_usda(file("path.usda"), images);
    const interchange::UsdLayer layer = interchange::read_usda(file("path.usda"));
    EXPECT_EQ(layer.number("metersPerUnit", 0), 1);
    EXPECT_EQ(layer.text("upAxis", ""), "Y");
    EXPECT_EQ(layer.number("timeCodesPerSecond", 0), kFps);
    EXPECT_EQ(layer.number("endTimeCode", 0), 14);
    const auto& attributes = layer.prims.at(0).attributes;
    for (size_t i = 0; i < images.keys.size(); ++i) {
        const auto number = [&](const char* name, size_t n = 0) {
            const interchange::UsdAttribute& attribute = attributes.at(name);
            if (attribute.samples.empty()) return attribute.value.numbers.at(n);
            EXPECT_EQ(attribute.samples.at(i).first, static_cast<double>(i));
            return attribute.samples.at(i).second.numbers.at(n);
        };
        const glm::dvec3 place(number("xformOp:translate", 0), number("xformOp:translate", 1),
                               number("xformOp:translate", 2));
        const glm::dquat turn(number("xformOp:orient", 0), number("xformOp:orient", 1), number("xformOp:orient", 2),
                              number("xformOp:orient", 3));
        const glm::dvec3 seen = glm::conjugate(turn) * (kPoint - place);
        const double focal = number("focalLength");
        const auto across = [&](double slope, const char* size, const char* offset) {
            return (slope * focal - number(offset)) / number(size) + 0.5;
        };
        const double x = kPathWidth * across(-seen.x / seen.z, "horizontalAperture", "horizontalApertureOffset");
        const double y = kPathHeight * (1 - across(-seen.y / seen.z, "verticalAperture", "verticalApertureOffset"));
        const glm::dvec2 expected =
            expected_pixel(path, static_cast<double>(i) / kFps) + glm::dvec2(0.1, -0.05) * (1.0 * kPathHeight);
        EXPECT_LT(glm::distance(glm::dvec2(x, y), expected), 1e-4);
    }
    expect_read_back("path.usda", 1e-7);
    EXPECT_NEAR(interchange::read_camera_path(file("path.usda"), 1).keys[3].shift.y, -0.05, 1e-7);
}

// As other programs write it: +Z up, centimetres, frames from 1, rotations by axes, a scaled parent, comments.
constexpr const char* kForeignUsd = R"(#usda 1.0
(
    """A shot, by hand"""
    doc = "it's #1"
    metersPerUnit = 0.01
    startTimeCode = 1
    timeCodesPerSecond = 24
    upAxis = "Z"
    customLayerData = { string maker = "me { }"; dictionary more = { int a = 1 } }
)
def Xform "root" ( kind = "group"
    prepend references = @./set.usda@</Set> (offset = 2)
    variants = { string look = "dark" } )
{
    double3 xformOp:scale = (2, 2, 2)
    uniform token[] xformOpOrder = ["xformOp:scale"]
    variantSet "look" = { "dark" ( doc = "no light" ) { over "x" { int a = 1 } } }
    def Mesh "floor" { int[] faceVertexIndices = [0, 1, 2,]
        rel material:binding = </root/grey>
        texCoord2f[] primvars:st = [(0, 0), (1, 1)] ( interpolation = "vertex" )
        float unused }
    def Camera "flat" { token projection = "orthographic" }
    def Camera "shot"
    {
        float focalLength = 24 # mm
        float verticalAperture = 24
        custom float focalLength.connect = </root/lens.out>
        double3 xformOp:translate:move.timeSamples = { 1: (0, 0, 50), 25: (100, 0, 50), }
        float3 xformOp:rotateXYZ = (90, 0, 90)
        uniform token[] xformOpOrder = ["xformOp:translate:move", "xformOp:rotateXYZ"]
    }
}
)";

TEST_F(CameraPathWrite, UsdOfOtherPrograms) {
    write_text(file("shot.usda"), kForeignUsd);
    const stage::CameraPath back = interchange::read_camera_path(file("shot.usda"), 25);
    ASSERT_EQ(back.keys.size(), 2u);
    EXPECT_EQ(back.keys[0].time_s, 0);
    EXPECT_EQ(back.keys[1].time_s, 1);
    EXPECT_LT(glm::distance(back.keys[0].position, glm::dvec3(0, 1, 0)), 1e-12);
    EXPECT_LT(glm::distance(back.keys[1].position, glm::dvec3(2, 1, 0)), 1e-12);
    // Turned by 90° about x it looks along +Y, and then by 90° about z along −X, with +Z up.
    const glm::dvec3 view = back.keys[1].world_from_camera * glm::dvec3(0, 0, -1);
    EXPECT_LT(glm::distance(view, glm::dvec3(-1, 0, 0)), 1e-12) << view.x << " " << view.y << " " << view.z;
    EXPECT_LT(glm::distance(back.keys[1].world_from_camera * glm::dvec3(0, 1, 0), glm::dvec3(0, 1, 0)), 1e-12);
    EXPECT_NEAR(back.keys[0].angle_y, 2 * std::atan(0.5), 1e-12);
}

TEST_F(CameraPathWrite, DamagedUsdIsRefused) {
    const auto refuses = [&](const std::string& text, std::initializer_list<std::string> parts) {
        write_text(file("shot.usda"), text);
        expect_input_error([&] { interchange::read_camera_path(file("shot.usda"), 25); }, parts);
    };
    const std::string head = "#usda 1.0\n";
    refuses("PXR-USDC\1", {"shot.usda", "binary", "usdcat"});
    refuses("hello", {"shot.usda", "#usda"});
    refuses(head, {"shot.usda", "no perspective camera", "flatten"});
    refuses(head + "def Camera \"a\" {", {"line 2", "attribute"});
    refuses(head + "def Camera \"a\" { float focalLength = }", {"line 2"});
    refuses(head + "def Camera \"a\" { float focalLength = 0 }", {"lens"});
    refuses(head + "def Camera \"a\" { double3 x.timeSamples = { 2: (1), 1: (2) } }", {"does not ascend"});
    refuses(head + "def Camera \"a\" { uniform token[] xformOpOrder = [\"xformOp:scale\"] }", {"xformOp:scale"});
    refuses(head +
                "def Camera \"a\" { float3 xformOp:scale = (1, 0, 1)\n uniform token[] xformOpOrder = "
                "[\"xformOp:scale\"] }",
            {"sheared, flat or mirrored"});
    refuses(head + "def Camera \"a\" {\n float f = " + std::string(5000, '(') + "}", {"line 3", "too deep"});
    refuses(head + "def \"a\" { " +
                [] {
                    std::string prims;
                    for (int i = 0; i < 5000; ++i) prims += "def \"a\" { ";
                    return prims;
                }(),
            {"too deep"});
    // Damage at random: a path, or an error.
    interchange::write_camera_usda(file("path.usda"), images);
    const std::vector<std::string> sound = {kForeignUsd, read_text(file("path.usda"))};
    fuzz::Random random(7);
    size_t read = 0;
    for (int i = 0; i < 600; ++i) {
        write_text(file("shot.usda"), fuzz::mutate(sound[static_cast<size_t>(i % 2)], sound, 20000, random));
        try {
            const stage::CameraPath path_read = interchange::read_camera_path(file("shot.usda"), 25);
            const stage::Camera camera = stage::camera_at(path_read, 0.5, 8, 8);
            EXPECT_TRUE(std::isfinite(camera.fx) && camera.fx > 0);
            EXPECT_TRUE(std::isfinite(glm::length(glm::dvec3(camera.world_from_camera[3]))));
            ++read;
        } catch (const InputError&) {
        }
    }
    EXPECT_GT(read, 30u);
    EXPECT_LT(read, 570u);
}

}  // namespace
}  // namespace neuvv
