// neuvv render: camera paths, linear images, and renders that are interrupted and resumed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "interchange/camera/camera_path_file.h"
#include "media/exr.h"
#include "media/image_sink.h"
#include "media/video.h"
#include "support/child_process.h"
#include "support/mpirun.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "support/waver_tree.h"
#include "tests/tools/cli_gpu.h"
#include "voctree/files/nvpaint.h"
#include "voctree/files/occupied_box.h"

namespace neuvv {
namespace {

struct CliRender : CliGpu {
    // Three keys around the scene, in three seconds.
    std::string write_path(bool cyclic) {
        stage::CameraPath path;
        path.cyclic = cyclic;
        const std::vector<tools::ViewStep> orbit =
            tools::orbit_path(voctree::occupied_box(tree), {{0, 3}, 2, 2}, {48, 40});
        for (size_t i = 0; i < 3; ++i) {
            const stage::Camera& camera = orbit[2 * i].camera;
            stage::CameraPathKey key;
            key.time_s = static_cast<double>(i);
            key.position = glm::dvec3(camera.world_from_camera[3]);
            key.world_from_camera = glm::quat_cast(glm::dmat3(camera.world_from_camera));
            key.angle_y = 2 * std::atan(0.5 * camera.height / camera.fy);
            path.keys.push_back(key);
        }
        path.duration_s = cyclic ? 3 : 2;
        interchange::write_camera_path(file("path.json"), path);
        return file("path.json");
    }
    std::vector<std::string> command(const std::string& output, std::initializer_list<std::string> more) {
        std::vector<std::string> words = {"render", "--overwrite", scene, "-o", file(output.c_str()),
                                          "--size", "48x40"};
        words.insert(words.end(), more);
        return words;
    }
    // Runs the program until the record says that so many images are finished, and stops it.
    void interrupt(const std::vector<std::string>& words, const std::filesystem::path& record, uint32_t finished,
                   int signal, int code) {
        std::vector<std::string> all = {NEUVV_PROGRAM};
        all.insert(all.end(), words.begin(), words.end());
        test::ChildProcess child(all, folder.path / "log");
        ASSERT_TRUE(child.until([&] {
            const std::string text = read_text(record);  // which is replaced as a whole
            return !text.empty() && nlohmann::json::parse(text).at("finished") >= finished;
        }));
        child.send(signal);
        ASSERT_EQ(child.wait(), code) << read_text(folder.path / "log");
    }
};

TEST_F(CliRender, PathsAreFollowed) {
    const std::string path = write_path(false);
    const ProgramResult result = run_neuvv(command("o_%02d.png", {"--camera", path, "--fps", "2", "--json"}));
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out).at("images"), 5);
    // The keys of the path are the views of the orbit.
    ASSERT_EQ(run_neuvv(command("orbit_%02d.png", {})).code, 0);
    for (int i = 0; i < 3; ++i) {
        const media::Image seen = media::read_png(folder.path / ("o_0" + std::to_string(2 * i) + ".png"));
        const media::Image truth = media::read_png(folder.path / ("orbit_0" + std::to_string(2 * i) + ".png"));
        size_t off = 0;
        for (size_t p = 0; p < seen.rgba.size(); ++p) off += std::abs(seen.rgba[p] - truth.rgba[p]) > 1;
        EXPECT_LT(off, seen.rgba.size() / 200)
            << i;  // transforms differ by rounding, which matters to rays at the edges of leaves
    }
    EXPECT_NE(media::read_png(file("o_01.png")).rgba, media::read_png(file("o_00.png")).rgba);
    expect_refused(command("o.png", {"--camera", path}), 2, {"--output", "is one file for"});
    write_text(file("other.json"), "{\"a\": 1}");
    expect_refused(command("o_%d.png", {"--camera", file("other.json")}), 2, {"other.json", "no camera path"});
}

// Parts of a render, as several processes make them, are what one process makes.
TEST_F(CliRender, PartsAreTheWhole) {
    const auto part = [&](const char* output, const char* which) {
        const ProgramResult result = run_neuvv(command(output, {"--part", which}));
        EXPECT_EQ(result.code, 0) << result.err;
        return result.err;
    };
    ASSERT_EQ(run_neuvv(command("one_%d.png", {})).code, 0);
    part("parts_%d.png", "1/2");
    EXPECT_FALSE(std::filesystem::exists(file("parts_7.png")));
    part("parts_%d.png", "2/2");
    for (int i = 0; i < 8; ++i)
        EXPECT_EQ(media::read_png(folder.path / ("parts_" + std::to_string(i) + ".png")).rgba,
                  media::read_png(folder.path / ("one_" + std::to_string(i) + ".png")).rgba);

    ASSERT_EQ(run_neuvv(command("one.mp4", {})).code, 0);
    EXPECT_NE(part("parts.mp4", "3/3").find("missing in " + file("parts.mp4.parts") + ": 2"), std::string::npos);
    EXPECT_NE(part("parts.mp4", "1/3").find("parts: 1"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(file("parts.mp4")));
    const ProgramResult again = run_neuvv(command("parts.mp4", {"--part", "1/3", "--resume", "--json"}));
    EXPECT_EQ(nlohmann::json::parse(again.out).at("rendered"), 0) << "it is there";
    part("parts.mp4", "2/4");  // of another division, which does not mix with these
    EXPECT_NE(part("parts.mp4", "2/3").find("joined all 3 parts: 8 images"), std::string::npos);
    const media::VideoSummary one = media::summarise_video(file("one.mp4")),
                              joined = media::summarise_video(file("parts.mp4"));
    EXPECT_EQ(joined.frames, one.frames);
    EXPECT_EQ(joined.fps, one.fps);
    media::VideoReader a(file("one.mp4")), b(file("parts.mp4"));
    for (media::Image of_a, of_b; a.next(of_a) && b.next(of_b);) {
        double difference = 0;
        for (size_t p = 0; p < of_a.rgba.size(); ++p) difference += std::abs(of_a.rgba[p] - of_b.rgba[p]);
        EXPECT_LT(difference / static_cast<double>(of_a.rgba.size()), 2);
    }
    const ProgramResult whole = run_neuvv(command("parts.mp4", {"--part", "1/3", "--resume", "--json"}));
    EXPECT_EQ(nlohmann::json::parse(whole.out).at("rendered"), 0) << "all parts are joined";
    EXPECT_FALSE(std::filesystem::exists(file("parts.mp4.lock")));
    EXPECT_FALSE(std::filesystem::exists(file("parts.mp4.lock")));

    for (const char* wrong : {"0/2", "3/2", "2", "a/b", "1/0", "1/2x", "-1/2"})
        expect_refused(command("x.mp4", {"--part", wrong}), 2, {"--part", wrong});
    expect_refused(command("x.mp4", {"--part", "1/9"}), 2, {"--part", "8 images"});
}

// Ranks take parts by themselves.
TEST_F(CliRender, RanksOfMpirunRenderParts) {
    if (!test::prepare_mpirun()) GTEST_SKIP() << "needs mpirun (package openmpi-bin)";
    std::vector<std::string> words = command("ranks.mp4", {});
    words.insert(words.begin(), NEUVV_PROGRAM);
    test::ChildProcess job(test::under_mpirun("2", words), folder.path / "log");
    EXPECT_EQ(job.wait(), 0) << read_text(folder.path / "log");
    EXPECT_EQ(media::summarise_video(file("ranks.mp4")).frames, 8u) << read_text(folder.path / "log");
    EXPECT_FALSE(std::filesystem::exists(file("ranks.mp4.parts")));
}

// A path of nerfstudio has its own rate; a clip and a stage show both ends of a path.
TEST_F(CliRender, AClipInSegmentsShowsWhatOneFileDoes) {
    const std::string path = write_path(true), parts = file("parts.nvv");
    write_segmented_copy(tree, {2, 2}, parts);
    for (const char* direct : {"", "--direct"}) {
        const auto images = [&](const std::string& clip) {
            std::vector<std::string> words = {"render", "--overwrite", clip,       "-o", file("s_%d.png"),
                                              "--size", "24x20",       "--camera", path, "--fps",
                                              "2"};
            if (*direct) words.emplace_back(direct);
            const ProgramResult result = run_neuvv(words);
            EXPECT_EQ(result.code, 0) << result.err;
            std::vector<media::Image> read;
            for (int i = 0; i < 6; ++i)
                read.push_back(media::read_png(file(("s_" + std::to_string(i) + ".png").c_str())));
            return read;
        };
        const auto one = images(scene), many = images(parts);
        for (size_t i = 0; i < one.size(); ++i) EXPECT_EQ(many[i].rgba, one[i].rgba) << i << direct;
    }
}

TEST_F(CliRender, FarPerformersAreDrawnFromCoarserLevelsUnlessThatIsOff) {
    voctree::write_nvv(scene, test::waver_tree());
    test::write_stage(file("show.gltf"), scene, "anna");
    for (const std::string& shown : {scene, file("show.gltf")}) {
        const auto image = [&](const char* name, const std::vector<std::string>& more) {
            std::vector<std::string> words = {"render", "--overwrite", shown,       "-o", file(name),
                                              "--size", "20x20",       "--samples", "1"};
            words.insert(words.end(), more.begin(), more.end());
            const ProgramResult result = run_neuvv(words);
            EXPECT_EQ(result.code, 0) << result.err;
            return media::read_png(file(name)).rgba;
        };
        const std::string range = shown == scene ? "--frames" : "--time";
        const auto without = image("off.png", {range, "0", "--far-levels", "off"});
        EXPECT_NE(image("default.png", {range, "0"}), without);
        EXPECT_EQ(image("on.png", {range, "0", "--far-levels", "on"}), image("default.png", {range, "0"}));
    }
    expect_refused(command("o.png", {"--far-levels", "sideways"}), 2, {"--far-levels"});
}

TEST_F(CliRender, PathsHaveAsManyImagesOnAStage) {
    nlohmann::json path = {{"camera_type", "perspective"},
                           {"render_width", 48},
                           {"render_height", 40},
                           {"fps", 4},
                           {"default_transition_sec", 1.0}};
    for (int i = 0; i < 2; ++i) {
        nlohmann::json key = {{"fov", 50}, {"matrix", {1, 0, 0, 0.1 * i, 0, 0, -1, -3, 0, 1, 0, 0.5, 0, 0, 0, 1}}};
        path["keyframes"].push_back(key);
    }
    write_text(file("nerf.json"), path.dump());
    const std::string show = file("show.gltf");
    test::write_stage(show, scene, "scene");
    const auto images = [&](const std::string& what, const std::vector<std::string>& more) {
        std::vector<std::string> words = {"render",   "--overwrite",     what,    "-o", file("p_%d.png"),
                                          "--camera", file("nerf.json"), "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult result = run_neuvv(words);
        EXPECT_EQ(result.code, 0) << result.err;
        return nlohmann::json::parse(result.out).at("images").get<int>();
    };
    for (const std::string& what : {scene, show}) {
        EXPECT_EQ(images(what, {"--fps", "2"}), 3) << what;
        EXPECT_EQ(images(what, {}), 5) << what << ": at the path's own rate";
    }
    path["keyframes"].erase(size_t{1});
    write_text(file("nerf.json"), path.dump());
    for (const std::string& what : {scene, show})
        EXPECT_EQ(images(what, {"--fps", "2"}), 4) << what << ": a fixed camera sees all of the clip's two seconds";
}

TEST_F(CliRender, PaintIsNamedAsItIsMeant) {
    voctree::write_paint(file("a.nvpaint"), {voctree::painted_field(voctree::read_nvv(scene)), {}});
    const auto refused = [&](const std::string& paint, const std::vector<std::string>& parts) {
        expect_refused({"render", scene, "-o", file("x.png"), "--frames", "0", "--paint", paint}, 2, parts);
    };
    refused(file("a.nvpaint") + ":screen", {"there is no blend `screen`", "multiply"});
    refused(file("a.nvpaint") + ":screen:0.5", {"there is no blend `screen`"});
    refused(file("a.nvpaint") + ":tint:80", {"80 is no opacity", "0 to 1"});
    refused(file("a.nvpaint") + ":80", {"80 is no opacity", "0 to 1"});
    refused(file("gone.nvpaint"), {"gone.nvpaint", "no such file"});
    refused(scene, {"is a clip, not a layer of paint"});
}

TEST_F(CliRender, LinearImagesAreTheImagesBeforeTheyBecomeSrgb) {
    ASSERT_EQ(run_neuvv(command("one.png", {"--frames", "1.5"})).code, 0);
    const ProgramResult result = run_neuvv(command("one.exr", {"--frames", "1.5"}));
    ASSERT_EQ(result.code, 0) << result.err;
    const media::Image image = media::read_png(file("one.png"));
    const media::LinearImage linear = media::read_exr(file("one.exr"));
    ASSERT_EQ(linear.width, 48u);
    ASSERT_EQ(linear.depth_m.size(), size_t{48 * 40});
    size_t seen = 0;
    for (size_t p = 0; p < linear.depth_m.size(); ++p) {
        const float alpha = linear.rgba[4 * p + 3];
        EXPECT_NEAR(image.rgba[4 * p + 3], 255 * alpha, 0.75);  // half a step of 8 bits, and the rounding of an fp16
        EXPECT_EQ(std::isfinite(linear.depth_m[p]), alpha > 0);
        seen += alpha > 0.2f;
        for (size_t c = 0; c < 3 && alpha > 0.2f; ++c)
            EXPECT_NEAR(image.rgba[4 * p + c],
                        255 * media::srgb_from_linear(std::min(1.0, double{linear.rgba[4 * p + c]} / double{alpha})),
                        1.5);
    }
    EXPECT_GT(seen, 50u);
    for (const char* flag : {"--depth", "--alpha", "--level", "--cost"})
        expect_refused(command("one.exr", {"--frames", "1", flag}), 2, {flag, "at once"});
    expect_refused(command("one.exr", {"--frames", "1", "--scale", "0.5"}), 2, {"--scale", "not linear"});
}

// A render is stopped by Ctrl-C's signal, then killed. Resumed, it writes the same bytes as a run without interruption,
// and renders no image twice.
TEST_F(CliRender, PassesAreListedAndShown) {
    const ProgramResult list = run_neuvv({"render", "--pass", "list"});
    EXPECT_EQ(list.code, 0) << list.err;
    for (const char* word : {"tile-near", "depth", "set-shadow", "[m]", "of stages"})
        EXPECT_NE(list.out.find(word), std::string::npos) << word << " in\n" << list.out;
    const ProgramResult result = run_neuvv(command("near.png", {"--frames", "0", "--pass", "tile-near"}));
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("tile-near from "), std::string::npos) << result.out;
    EXPECT_EQ(media::read_png(file("near.png")).width, 2 * 48u / 8);
    expect_refused(command("x.png", {"--pass", "soup"}), 2, {"soup", "--pass list"});
    expect_refused(command("x.mp4", {"--pass", "depth"}), 2, {"--pass", "out.png"});
    expect_refused(command("x.png", {"--pass", "set-depth", "--frames", "0"}), 2, {"set-depth", "is for stages"});
    expect_refused(command("x.png", {"--pass", "depth", "--direct"}), 2, {"--pass", "--direct"});
}

TEST_F(CliRender, AnInterruptedSequenceGoesOn) {
    const std::string path = write_path(true);
    for (const char* ending : {"png", "exr"}) {
        const std::string whole = std::string("whole_%03d.") + ending, fps = "8";
        const std::string broken = fmt::format("broken_{0}_%03d.{0}", ending);  // each with a record of its own
        const std::string third = fmt::format("broken_{0}_003.{0}", ending);
        const std::string record = fmt::format("broken_{}_render.json", ending);
        ASSERT_EQ(run_neuvv(command(whole, {"--camera", path, "--fps", fps})).code, 0);
        const auto words = command(broken, {"--camera", path, "--fps", fps, "--resume", "--json"});
        interrupt(words, file(record.c_str()), 4, ending[0] == 'p' ? SIGTERM : SIGKILL,
                  ending[0] == 'p' ? 1 : -SIGKILL);
        const bool told = read_text(file("log")).find("--resume goes on with it") != std::string::npos;
        EXPECT_EQ(told, ending[0] == 'p');
        const auto written = std::filesystem::last_write_time(file(third.c_str()));
        const ProgramResult result = run_neuvv(words);
        ASSERT_EQ(result.code, 0) << result.err;
        const auto json = nlohmann::json::parse(result.out);
        EXPECT_EQ(json.at("images"), 24);
        EXPECT_LE(json.at("rendered"), 20);
        EXPECT_EQ(std::filesystem::last_write_time(file(third.c_str())), written);
        for (uint32_t i = 0; i < 24; ++i)
            EXPECT_EQ(read_text(media::parse_output(file(broken.c_str())).file(i)),
                      read_text(media::parse_output(file(whole.c_str())).file(i)))
                << ending << " " << i;
        EXPECT_EQ(nlohmann::json::parse(run_neuvv(words).out).at("rendered"), 0);
        auto other = words;
        other.insert(other.end(), {"--samples", "1"});
        expect_refused(other, 2, {record, "--samples", "was 2", "is 1 now"});
    }
}

TEST_F(CliRender, AnInterruptedVideoGoesOnWhereItWasBegunSo) {
    // x264's output for the same images varies from run to run where they are smaller.
    const std::vector<std::string> rest = {"--size", "128x96", "--fps", "8", "--samples", "1", "--json"};
    const auto words_of = [&](const char* name) {
        std::vector<std::string> words = {"render", "--overwrite", scene, "-o", file(name)};
        words.insert(words.end(), rest.begin(), rest.end());
        return words;
    };
    std::vector<std::string> words = words_of("v.mp4");
    words.push_back("--resume");
    interrupt(words, folder.path / "v.mp4.frames/render.json", 5, SIGINT, 1);
    EXPECT_FALSE(std::filesystem::exists(file("v.mp4")));
    const ProgramResult result = run_neuvv(words);
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_LE(nlohmann::json::parse(result.out).at("rendered"), 27);
    EXPECT_FALSE(std::filesystem::exists(file("v.mp4.frames")));
    ASSERT_EQ(run_neuvv(words_of("straight.mp4")).code, 0);
    media::VideoReader a(file("v.mp4")), b(file("straight.mp4"));
    EXPECT_EQ(a.frames(), 32u);
    media::Image of_a, of_b;
    while (a.next(of_a)) {
        ASSERT_TRUE(b.next(of_b));
        EXPECT_EQ(of_a.rgba, of_b.rgba);
    }
}

}  // namespace
}  // namespace neuvv
