// tools/benchmark on stand-ins of the data sets: captures of the bundled performer in each benchmark's layout.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "media/video.h"
#include "support/easymocap_files.h"
#include "support/environment_value.h"
#include "support/npz_files.h"
#include "support/performer_capture.h"
#include "tests/tools/run_neuvv.h"
#include "training/data/reduce.h"

namespace neuvv {
namespace {

using nlohmann::json;
using Names = std::vector<std::string>;

constexpr int kShotFrames = 2;
const std::string kScript = std::string(NEUVV_SOURCE_DIR) + "/tools/benchmark";

struct CliBenchmark : testing::Test {
    TemporaryFolder folder;
    test::EnvironmentValue program{"NEUVV", NEUVV_PROGRAM};
    // 13 cameras, two frames, of 96×96 pixels; captured once for all tests.
    const training::Dataset& captured = capture();

    static const training::Dataset& capture() {
        static const TemporaryFolder made;
        static const training::Dataset dataset = test::performer_capture(made.path);
        return dataset;
    }
    std::filesystem::path data(const std::string& scene) const { return folder.path / scene; }
    std::filesystem::path out() const { return folder.path / "out"; }

    const training::View& view_of(size_t camera, int frame) const {
        return *std::ranges::find_if(
            captured.views, [&](const training::View& view) { return view.camera == camera && view.time == frame; });
    }
    // What the camera would see before a grey wall, and its matte.
    media::Image photograph(size_t camera, int frame) const {
        const uint8_t grey[3] = {90, 90, 90};
        return media::composite_over(view_of(camera, frame).image.whole(), grey);
    }
    media::Image matte(size_t camera, int frame) const {
        media::Image image = view_of(camera, frame).image.whole();
        for (size_t i = 0; i < image.rgba.size(); i += 4) {
            std::fill_n(&image.rgba[i], 3, image.rgba[i + 3]);
            image.rgba[i + 3] = 255;
        }
        return image;
    }
    static void write_image(const std::filesystem::path& file, const media::Image& image) {
        std::filesystem::create_directories(file.parent_path());
        media::write_png(file, image);
    }
    // Columns are OpenCV's axes of the camera: right, down, forwards.
    glm::dmat3 opencv_axes(size_t camera) const {
        const glm::dmat4& pose = captured.cameras[camera].world_from_camera;
        return {glm::dvec3(pose[0]), -glm::dvec3(pose[1]), -glm::dvec3(pose[2])};
    }
    glm::dvec3 position(size_t camera) const { return captured.cameras[camera].world_from_camera[3]; }

    void write_easymocap(const std::filesystem::path& to, const Names& names) const {
        std::string intrinsics = test::yaml_names(names), extrinsics = intrinsics;
        for (size_t i = 0; i < names.size(); ++i) {
            const stage::Camera& camera = captured.cameras[i];
            const glm::dmat3 rotation = glm::transpose(opencv_axes(i));
            const glm::dvec3 shift = -(rotation * position(i));
            intrinsics += test::yaml_matrix("K_" + names[i], 3, 3,
                                            {camera.fx, 0, camera.cx - 0.5, 0, camera.fy, camera.cy - 0.5, 0, 0, 1});
            std::vector<double> rows;
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column) rows.push_back(rotation[column][row]);
            extrinsics += test::yaml_matrix("Rot_" + names[i], 3, 3, rows);
            extrinsics += test::yaml_matrix("T_" + names[i], 3, 1, {shift.x, shift.y, shift.z});
        }
        write_text(to / "intri.yml", intrinsics);
        write_text(to / "extri.yml", extrinsics);
    }
    void write_photographs(const std::filesystem::path& to, const Names& names, int first) const {
        for (size_t i = 0; i < names.size(); ++i)
            for (int frame = 0; frame < kShotFrames; ++frame) {
                const std::string name = fmt::format("{:06}", first + frame);
                write_image(to / "images" / names[i] / (name + ".png"), photograph(i, frame));
                write_image(to / "masks" / names[i] / (name + ".png"), matte(i, frame));
            }
    }
    void write_videos(const std::filesystem::path& to, const Names& names) const {
        std::filesystem::create_directories(to);
        for (size_t i = 0; i < names.size(); ++i) {
            media::VideoWriter video(to / (names[i] + ".mp4"), 96, 96, 30);
            for (int frame = 0; frame < kShotFrames; ++frame) video.add(photograph(i, frame));
            video.finish();
        }
    }

    struct Said {
        int code;
        std::string text;
    };
    Said run(const std::string& name, const std::string& scene, const Names& more = {}) const {
        Names command{kScript, name, data(scene).string(), "-o", out().string(), "--steps", "3"};
        command.insert(command.end(), more.begin(), more.end());
        const std::filesystem::path log = folder.path / "log.txt";
        test::ChildProcess child(command, log);
        const int code = child.wait();
        return {code, read_text(log)};
    }
    json result() const { return json::parse(read_text(out() / "result.json")); }
    // "CAMERA FRAME" of each image of a split.
    static std::set<std::string> images(const json& result, const std::string& split) {
        std::set<std::string> found;
        for (const json& image : result.at("data").at("images").at(split))
            found.insert(fmt::format("{} {}", image.at(0).get<std::string>(), image.at(1).get<int>()));
        return found;
    }
    static bool differs(const json& result, const std::string& text) {
        return std::ranges::any_of(result.at("differs"), [&](const json& one) {
            return one.at("text").get<std::string>().find(text) != std::string::npos;
        });
    }
    static void expect_line(const Said& said, const Names& parts) {
        EXPECT_EQ(said.code, 2) << said.text;
        const std::string last = said.text.substr(said.text.rfind("tools/benchmark: "));
        EXPECT_EQ(std::ranges::count(last, '\n'), 1) << said.text;
        for (const std::string& part : parts) EXPECT_NE(last.find(part), std::string::npos) << part << ": " << last;
    }
};

TEST_F(CliBenchmark, DNerfIsMeasuredOverBlackOnItsOwnTestImages) {
    for (const auto& [split, first] : {std::pair("train", 0), std::pair("test", 7)}) {
        json document{{"camera_angle_x", 2 * std::atan(48 / captured.cameras[0].fx)}};
        for (int i = 0; i < (first == 0 ? 7 : 2); ++i) {
            const auto camera = static_cast<size_t>(first + i);
            json frame{{"file_path", fmt::format("./{}/r_{:03}", split, i)}, {"time", i % 2}};
            for (int row = 0; row < 4; ++row)
                for (int column = 0; column < 4; ++column)
                    frame["transform_matrix"][row][column] = captured.cameras[camera].world_from_camera[column][row];
            document["frames"].push_back(frame);
            write_image(data("hook") / split / fmt::format("r_{:03}.png", i), view_of(camera, i % 2).image.whole());
        }
        write_text(data("hook") / fmt::format("transforms_{}.json", split), document.dump());
    }
    const Said said = run("dnerf", "hook");
    ASSERT_EQ(said.code, 0) << said.text;
    EXPECT_NE(said.text.find("--split test --background black --crop none"), std::string::npos) << said.text;
    EXPECT_NE(said.text.find("|Deformable 3DGS|37.42|||Deformable 3DGS, arXiv:2309.13101, Table 1|"),
              std::string::npos);
    EXPECT_NE(read_text(out() / "table.md").find("|**NeuVV, 3 steps**|("), std::string::npos) << "of small images";
    json first = result();
    EXPECT_EQ(first.at("scene"), "hook");
    EXPECT_TRUE(first.at("comparable").empty());
    EXPECT_TRUE(differs(first, "of images of 96×96; published: 800×800"));
    EXPECT_GT(first.at("ours").at("psnr"), 3);

    const Said again = run("dnerf", "hook");
    EXPECT_EQ(again.code, 0) << again.text;
    EXPECT_NE(again.text.find("out/clip.nvv is finished"), std::string::npos) << again.text;
    EXPECT_EQ(result(), first);
    expect_line(run("dnerf", "hook", {"--scene", "lego"}), {"out holds another run", "--overwrite"});
    expect_line(run("dnerf", "hook", {"--scene", "nobody"}), {"nobody is no scene of D-NeRF", "lego"});
    std::filesystem::remove(data("hook") / "transforms_test.json");
    expect_line(run("dnerf", "hook"), {"hook is no folder of D-NeRF", "transforms_test.json"});
}

TEST_F(CliBenchmark, APlanRunsNothingAndSaysWhatDiffers) {
    // Two moments of two cameras, each pixel ten times as large.
    for (const char* split : {"train", "test"}) {
        json document{{"fl_x", 10 * captured.cameras[0].fx}};
        for (int i = 0; i < 2; ++i) {
            const glm::dmat4& pose = captured.cameras[static_cast<size_t>(i)].world_from_camera;
            const std::string name = fmt::format("{}/r_{:03}", split, i);
            json frame{{"file_path", name}, {"time", i}};
            for (int row = 0; row < 4; ++row)
                for (int column = 0; column < 4; ++column) frame["transform_matrix"][row][column] = pose[column][row];
            document["frames"].push_back(frame);
            const media::Image small = view_of(static_cast<size_t>(i), i).image.whole();
            media::Image large(800, 800);
            for (uint32_t y = 0; y < 800; ++y)
                for (uint32_t x = 0; x < 800; ++x) std::copy_n(small.at(8 + x / 10, 8 + y / 10), 4, large.at(x, y));
            write_image(data("jumpingjacks") / (name + ".png"), large);
        }
        write_text(data("jumpingjacks") / fmt::format("transforms_{}.json", split), document.dump());
    }
    const Said same = run("dnerf", "jumpingjacks", {"--plan"});
    EXPECT_EQ(same.code, 0) << same.text;
    EXPECT_NE(same.text.find("$ neuvv train "), std::string::npos) << same.text;
    EXPECT_EQ(same.text.find("differs: "), std::string::npos) << "all is as published: " << same.text;
    EXPECT_FALSE(std::filesystem::exists(out()));
    std::filesystem::rename(data("jumpingjacks"), data("mine"));
    const Said other = run("dnerf", "mine", {"--plan"});
    EXPECT_NE(other.text.find("differs: PSNR, SSIM, LPIPS of a scene that the benchmark does not know"),
              std::string::npos)
        << other.text;
    const Said lacking = run("dnerf", "mine", {"--plan", "--scene", "lego"});
    EXPECT_EQ(lacking.code, 2);
    EXPECT_NE(lacking.text.find("lacks transforms_val.json"), std::string::npos) << lacking.text;
    std::filesystem::rename(data("mine") / "transforms_test.json", data("mine") / "transforms_val.json");
    std::filesystem::copy(data("mine") / "transforms_val.json", data("mine") / "transforms_test.json");
    const Said lego = run("dnerf", "mine", {"--plan", "--scene", "lego"});
    EXPECT_NE(lego.text.find("--split val"), std::string::npos) << lego.text;
    EXPECT_NE(lego.text.find("val: 2 images"), std::string::npos) << lego.text;
    EXPECT_NE(run("dnerf", "mine", {"--plan", "--frames", "0:1"}).text.find("--frames chooses none"),
              std::string::npos);
}

TEST_F(CliBenchmark, ActorsHqMeasuresTheImagesOfHumanRf) {
    // Measured are cameras 1, 14 and 127; 11 is for validation.
    const Names names = {"Cam001", "Cam002", "Cam003", "Cam004", "Cam011", "Cam014", "Cam127"};
    std::string table = "name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py\r\n";
    for (size_t i = 0; i < names.size(); ++i) {
        const stage::Camera& camera = captured.cameras[i];
        const glm::dquat turn = glm::quat_cast(opencv_axes(i));
        const glm::dvec3 axis = glm::angle(turn) * glm::axis(turn), at = position(i);
        table += fmt::format("{},96,96,{},{},{},{},{},{},{},{},{},{}\r\n", names[i], axis.x, axis.y, axis.z, at.x, at.y,
                             at.z, camera.fx / 96, camera.fy / 96, camera.cx / 96, camera.cy / 96);
        for (int frame = 0; frame < kShotFrames; ++frame) {
            const auto file = [&](const char* folder_name, const char* word, const char* ending) {
                return data("4x") / folder_name / names[i] /
                       fmt::format("{}_{}{:06}.{}", names[i], word, 15 + frame, ending);
            };
            write_image(file("rgbs", "rgb", "jpg"), photograph(i, frame));
            write_image(file("masks", "mask", "png"), matte(i, frame));
        }
    }
    write_text(data("4x") / "calibration.csv", table);
    expect_line(run("actorshq", "4x"), {"4x lacks frame 17 of the frames 15 to 34", "--frames"});
    const Said said = run("actorshq", "4x", {"--frames", "15:16"});
    ASSERT_EQ(said.code, 0) << said.text;
    const json found = result();
    EXPECT_EQ(images(found, "train"),
              (std::set<std::string>{"Cam002 15", "Cam002 16", "Cam003 15", "Cam003 16", "Cam004 15", "Cam004 16"}));
    EXPECT_EQ(images(found, "test"), (std::set<std::string>{"Cam001 15", "Cam127 15"})) << "Cam014 has its turn later";
    EXPECT_NE(said.text.find("--background black --crop matte"), std::string::npos) << said.text;
    EXPECT_TRUE(differs(found, "of the frames 15 to 16; published: 15 to 34"));
    EXPECT_TRUE(differs(found, "without the cameras Cam025"));
    EXPECT_NE(read_text(out() / "table.md").find("|HumanRF|30.30*|||"), std::string::npos);
}

TEST_F(CliBenchmark, ZjuTrainsOnItsCamerasByPlace) {
    Names names;
    for (int i = 1; i <= 13; ++i) names.push_back(fmt::format("Camera_B{}", i));
    write_easymocap(data("CoreView_313"), names);
    write_photographs(data("CoreView_313"), names, 0);
    const Said said = run("zju", "CoreView_313", {"--frames", "0:1"});
    ASSERT_EQ(said.code, 0) << said.text;
    const json found = result();
    EXPECT_EQ(found.at("scene"), "313");
    EXPECT_EQ(images(found, "train").size(), 6u);
    EXPECT_TRUE(images(found, "train").contains("Camera_B7 1"));
    const std::set<std::string> measured = images(found, "test");
    EXPECT_EQ(measured.size(), 10u) << "every 30th frame";
    EXPECT_FALSE(measured.contains("Camera_B13 0") || measured.contains("Camera_B2 1"));
    EXPECT_TRUE(differs(found, "of images of 48×48; published: 512×512"));
    EXPECT_TRUE(differs(found, "without the cameras number 18"));
    EXPECT_NE(said.text.find("--reduce 2"), std::string::npos);
    EXPECT_NE(said.text.find("|Neural Body|30.56|0.971||github.com/zju3dv/neuralbody"), std::string::npos) << said.text;
}

TEST_F(CliBenchmark, DnaHoldsOutItsFourCameras) {
    const Names names = {"03", "11", "12", "25", "36", "37", "57"};
    write_easymocap(data("0013_01"), names);
    write_photographs(data("0013_01"), names, 0);
    const Said said = run("dna", "0013_01", {"--frames", "0:1"});
    ASSERT_EQ(said.code, 0) << said.text;
    EXPECT_EQ(images(result(), "train"), (std::set<std::string>{"03 0", "03 1", "12 0", "12 1", "36 0", "36 1"}));
    EXPECT_EQ(images(result(), "test"), (std::set<std::string>{"11 0", "25 0", "37 0", "57 0"}));
    EXPECT_NE(said.text.find("|4K4D|31.99|0.982|0.040|4K4D, arXiv:2310.11448"), std::string::npos) << said.text;
    std::filesystem::rename(data("0013_01") / "masks", data("0013_01") / "other");
    expect_line(run("dna", "0013_01"), {"0013_01 is no folder of DNA-Rendering", "masks"});
}

TEST_F(CliBenchmark, N3dvHoldsOutTheFirstCameraAndNeedsMattes) {
    const Names names = {"cam00", "cam01", "cam04", "cam05"};
    std::vector<double> poses;
    for (size_t i = 0; i < names.size(); ++i) {
        const stage::Camera& camera = captured.cameras[i];
        const glm::dmat4& pose = camera.world_from_camera;
        const double numbers[3] = {96, 96, camera.fx};
        for (int row = 0; row < 3; ++row)
            for (const double value : {-pose[1][row], pose[0][row], pose[2][row], pose[3][row], numbers[row]})
                poses.push_back(value);
        poses.insert(poses.end(), {1, 10});
    }
    write_videos(data("flame_steak"), names);
    write_text(data("flame_steak") / "poses_bounds.npy", test::npy_bytes("<f8", {4, 17}, test::bytes_of(poses)));
    write_text(data("flame_steak") / "cameras.json", "{}");  // no camera
    expect_line(run("n3dv", "flame_steak"), {"flame_steak lacks frame 2 of the frames 0 to 299"});
    const Names part = {"--frames", "0:1"};
    expect_line(run("n3dv", "flame_steak", part), {"out/data has no mattes", "`neuvv matte "});
    for (size_t i = 0; i < names.size(); ++i)
        for (int frame = 0; frame < kShotFrames; ++frame)
            write_image(folder.path / "mattes" / fmt::format("{}_f{:04}.png", names[i], frame),
                        training::reduced(matte(i, frame), 2));
    const ProgramResult brought =
        run_neuvv({"matte", (out() / "data").string(), "--from", (folder.path / "mattes").string()});
    ASSERT_EQ(brought.code, 0) << brought.err;
    const Said said = run("n3dv", "flame_steak", part);
    ASSERT_EQ(said.code, 0) << said.text;
    const json found = result();
    EXPECT_EQ(images(found, "test"), (std::set<std::string>{"cam00 0", "cam00 1"}));
    EXPECT_EQ(images(found, "train").size(), 6u);
    EXPECT_TRUE(differs(found, "of the performer alone"));
    EXPECT_TRUE(found.at("comparable").empty());
    EXPECT_NE(said.text.find("|Ex4DGS|33.91|"), std::string::npos) << said.text;
}

TEST_F(CliBenchmark, SelfCapTakesTheFramesOfItsScene) {
    const Names names = {"0007", "0014", "0015", "0016"};
    write_easymocap(data("hair-release") / "optimized", names);
    write_videos(data("hair-release") / "videos", names);
    for (size_t i = 0; i < names.size(); ++i)
        for (int frame = 0; frame < kShotFrames; ++frame)
            write_image(data("hair-release") / "mattes" / fmt::format("{}_{:06}.png", names[i], frame),
                        matte(i, frame));
    write_text(data("hair-release") / "optimized" / "sync.json", "{}");
    expect_line(run("selfcap", "hair-release"), {"is no scene of SelfCap", "dance1"});
    expect_line(run("selfcap", "hair-release", {"--scene", "dance1"}), {"lacks frame 4120 of the frames 4120 to 4179"});
    const Said said = run("selfcap", "hair-release", {"--scene", "dance1", "--frames", "0:1"});
    ASSERT_EQ(said.code, 0) << said.text;
    EXPECT_EQ(images(result(), "test"), (std::set<std::string>{"0015 0", "0015 1"}));
    EXPECT_EQ(images(result(), "train").size(), 6u);
    EXPECT_TRUE(differs(result(), "corrections of time in sync.json"));
    EXPECT_NE(said.text.find("|FreeTimeGS|29.38*||0.080*|FreeTimeGS, arXiv:2506.05348, Table 3"), std::string::npos)
        << said.text;
}

TEST_F(CliBenchmark, EachPublishedFigureHasASource) {
    const std::filesystem::path log = folder.path / "log.txt";
    test::ChildProcess list({kScript}, log);
    ASSERT_EQ(list.wait(), 0) << read_text(log);
    std::istringstream lines(read_text(log));
    size_t figures = 0, tables = 0;
    for (std::string line; std::getline(lines, line);) {
        tables += line == "|---|---|---|---|---|";
        if (!line.starts_with("|") || line.ends_with("|source|") || line.starts_with("|---")) continue;
        ++figures;
        EXPECT_EQ(std::ranges::count(line, '|'), 6) << line;
        const std::string source = line.substr(line.rfind('|', line.size() - 2));
        EXPECT_TRUE(source.find("arXiv:") != std::string::npos || source.find("github") != std::string::npos) << line;
    }
    EXPECT_EQ(tables, 6u + 8 + 9 + 1 + 1 + 1) << "of scenes, where figures are by scene";
    EXPECT_EQ(figures, 6u * 8 + 8 * 6 + 9 * 4 + 5 + 7 + 4);
    expect_line(run("n3d", "x"), {"n3d is none of the benchmarks n3dv"});
    expect_line(run("zju", "x"), {"x is no folder"});
    expect_line(run("zju", "x", {"--frames", "3:2"}), {"--frames 3:2 is no FIRST:LAST"});
}

}  // namespace
}  // namespace neuvv
