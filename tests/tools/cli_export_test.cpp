// neuvv export on the command line: its files as an independent reader and renderer of splats sees them.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "media/psnr.h"
#include "reference/splats.h"
#include "stage/stage.h"
#include "stream/transport/nvs_writer.h"
#include "tests/tools/cli_gpu.h"
#include "voctree/files/world_frame.h"

namespace neuvv {
namespace {

struct CliExported : CliGpu {
    nlohmann::json exported(const std::string& clip, const std::string& output, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"export",  "--overwrite", clip,     "-o",    output,
                                              "--views", "2",           "--size", "96x96", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProgramResult run = run_neuvv(arguments);
        EXPECT_EQ(run.code, 0) << run.err;
        return run.code == 0 ? nlohmann::json::parse(run.out) : nlohmann::json();
    }
    // PSNR of a .ply, drawn by the definition, against a render of the clip's frame by the program.
    double psnr_of(const std::string& ply, const std::string& clip, double frame) {
        const ProgramResult run = run_neuvv({"render", "--overwrite", clip, "-o", file("x.png"), "--frames",
                                             std::to_string(frame), "--size", "96x96", "--background", "white"});
        EXPECT_EQ(run.code, 0) << run.err;
        const media::Image shown = media::read_png(file("x.png"));
        const stage::Camera camera =
            tools::orbit_path(voctree::occupied_box(tree), {{frame, frame}, 2, 2}, {96, 96})[0].camera;
        const glm::dmat3 about_x(1, 0, 0, 0, -1, 0, 0, 0, -1), about_z(-1, 0, 0, 0, -1, 0, 0, 0, 1);
        const auto pixels = reference::draw_splats(
            reference::read_splats(ply),
            {about_x * glm::transpose(glm::dmat3(camera.world_from_camera)) * about_z,
             about_z * glm::dvec3(camera.world_from_camera[3]), camera.fx, camera.fy, camera.cx, camera.cy, 96, 96},
            glm::dvec3(1));
        media::Image drawn(96, 96);
        for (size_t i = 0; i < pixels.size(); ++i)
            for (size_t c = 0; c < 4; ++c)
                drawn.rgba[4 * i + c] =
                    static_cast<uint8_t>(c == 3 ? 255 : std::lround(255 * pixels[i][static_cast<int>(c)]));
        return media::psnr_db(shown, drawn);
    }
};

// Leaves that are small on the images, as those of trained clips are.
struct CliExport : CliExported {
    void SetUp() override {
        tree = test::random_tree({.node_levels = 3, .leaves = 3000, .bases = 4, .hh_degree = 1, .frames = 4});
        CliGpu::SetUp();
    }
};

TEST_F(CliExport, SplatsShowWhatTheClipDoes) {
    const nlohmann::json all = exported(scene, file("out_%02d.ply"), {});
    EXPECT_EQ(all.at("files"), 4);
    EXPECT_GT(all.at("psnr_db"), 25);
    EXPECT_GT(all.at("close_psnr_db"), 25);
    const auto shown = [&](uint32_t frame) {
        return psnr_of(file(("out_0" + std::to_string(frame) + ".ply").c_str()), scene, frame);
    };
    EXPECT_GT(shown(0), 24);
    EXPECT_GT(shown(3), 24);
    EXPECT_LT(psnr_of(file("out_00.ply"), scene, 3), shown(3) - 3) << "frames differ";
    EXPECT_NEAR(shown(2), all.at("psnr_db").get<double>(), 2);
    size_t splats = 0;
    for (const char* name : {"out_00.ply", "out_01.ply", "out_02.ply", "out_03.ply"})
        splats += reference::read_splats(file(name)).size();
    EXPECT_EQ(all.at("splats"), splats);
}

TEST_F(CliExport, ThereMayBeALimit) {
    const nlohmann::json all = exported(scene, file("all.ply"), {"--frames", "1"});
    const nlohmann::json few = exported(scene, file("few.ply"), {"--frames", "1", "--most-splats", "300"});
    EXPECT_LE(few.at("splats"), 300);
    EXPECT_GT(few.at("splats"), 290);
    EXPECT_GT(few.at("psnr_db"), all.at("psnr_db").get<double>() - 6) << "what remains shows as much";
}

TEST_F(CliExport, ResumeKeepsWhatIsThere) {
    exported(scene, file("out_%d.ply"), {"--frames", "0:1"});
    write_text(file("out_0.ply"), "kept");
    const nlohmann::json rest = exported(scene, file("out_%d.ply"), {"--resume"});
    EXPECT_EQ(rest.at("files"), 2);
    EXPECT_EQ(read_text(file("out_0.ply")), "kept");
    EXPECT_TRUE(std::filesystem::exists(file("out_3.ply")));
}

TEST_F(CliExport, OneFileHoldsAllFrames) {
    EXPECT_EQ(exported(scene, file("all.glb"), {}).at("files"), 1);
    EXPECT_EQ(exported(scene, file("all.usda"), {"--frames", "1:2"}).at("files"), 1);
    EXPECT_NE(read_text(file("all.usda")).find("endTimeCode = 1\n"), std::string::npos);
}

TEST_F(CliExport, FramesMayHaveAnotherRate) {
    exported(scene, file("own_%d.ply"), {});
    EXPECT_EQ(exported(scene, file("fast_%d.ply"), {"--fps", "4"}).at("files"), 8);
    for (const int frame : {0, 1, 2, 3})
        EXPECT_EQ(read_text(file(("fast_" + std::to_string(2 * frame) + ".ply").c_str())),
                  read_text(file(("own_" + std::to_string(frame) + ".ply").c_str())));
    EXPECT_EQ(read_text(file("fast_7.ply")), read_text(file("own_3.ply"))) << "the last frame stays";
    EXPECT_GT(psnr_of(file("fast_5.ply"), scene, 2.5), 24);
    EXPECT_GT(psnr_of(file("fast_5.ply"), scene, 2.5), psnr_of(file("own_3.ply"), scene, 2.5) + 2) << "it is mixed";
    // A part has the numbers that it has in the whole, and --resume finds them.
    EXPECT_EQ(exported(scene, file("part_%d.ply"), {"--fps", "1", "--frames", "2:3"}).at("files"), 1);
    EXPECT_TRUE(std::filesystem::exists(file("part_1.ply")));
    write_text(file("part_1.ply"), "kept");
    EXPECT_EQ(exported(scene, file("part_%d.ply"), {"--fps", "1", "--resume"}).at("files"), 1);
    EXPECT_EQ(read_text(file("part_1.ply")), "kept");
    expect_refused({"export", scene, "-o", file("x.ply"), "--frames", "1", "--fps", "1"}, 2,
                   {"--frames", "at 1 a second"});
}

TEST_F(CliExport, OneFileHasTheTimesOfItsRate) {
    exported(scene, file("all.usda"), {"--fps", "4", "--frames", "1:2"});
    const std::string usda = read_text(file("all.usda"));
    EXPECT_NE(usda.find("endTimeCode = 3\n"), std::string::npos);
    EXPECT_NE(usda.find("timeCodesPerSecond = 4\n"), std::string::npos);
    exported(scene, file("all.glb"), {"--fps", "4", "--frames", "1:2"});
    EXPECT_NEAR(stage::load_gltf(file("all.glb")).animations.at(0).duration_s, 1, 1e-6);
}

TEST_F(CliExport, StreamsAreExportedToo) {
    const ProgramResult publish =
        run_neuvv({"publish", "--overwrite", scene, "-o", file("x.nvs"), "--quality", "45", "--size", "64x64"});
    ASSERT_EQ(publish.code, 0) << publish.err;
    exported(scene, file("clip.ply"), {"--frames", "2"});
    exported(file("x.nvs"), file("stream.ply"), {"--frames", "2"});
    EXPECT_NEAR(psnr_of(file("stream.ply"), scene, 2), psnr_of(file("clip.ply"), scene, 2), 1);
}

TEST_F(CliExport, AStreamStandsWhereItsClipDoes) {
    const voctree::WorldFrame frame{{512350, 410, -5403210}, 0.01};
    voctree::write_nvv(scene, tree, voctree::ChunkOfFrame(frame).views());
    ASSERT_EQ(run_neuvv({"publish", "--overwrite", scene, "-o", file("x.nvs"), "--rate", "1000"}).code, 0);
    const nlohmann::json info = nlohmann::json::parse(run_neuvv({"info", file("x.nvs"), "--json"}).out);
    EXPECT_EQ(info.at("capture"), nlohmann::json::parse(run_neuvv({"info", scene, "--json"}).out).at("capture"));
    EXPECT_EQ(info.at("capture").at("origin").at(2), -5403210);
    const ProgramResult text = run_neuvv({"info", file("x.nvs")});
    EXPECT_NE(text.out.find("capture (512350, 410, -5403210) is the clip's origin"), std::string::npos) << text.out;
    std::string of_clip, of_stream;
    for (const auto& [clip, out] : {std::pair(scene, &of_clip), std::pair(file("x.nvs"), &of_stream)}) {
        exported(clip, file("x.usda"), {"--frames", "2"});
        *out = read_text(file("x.usda"));
    }
    constexpr const char* kOrigin = "(512350, 410, -5403210)";
    EXPECT_NE(of_clip.find(kOrigin), std::string::npos) << of_clip.substr(0, 1000);
    EXPECT_NE(of_stream.find(kOrigin), std::string::npos) << of_stream.substr(0, 1000);
}

TEST_F(CliExport, SaysWhatIsWrong) {
    expect_refused({"export", scene, "-o", file("x.xyz")}, 2, {"x.xyz", ".ply, .glb, .usda"});
    expect_refused({"export", scene, "-o", file("x.ply")}, 2, {"x.ply", "holds one frame, not 4", "out_%04d.ply"});
    expect_refused({"export", scene, "-o", file("x_%s.ply")}, 2, {"x_%s.ply", "out_%04d.ply"});
    expect_refused({"export", scene, "-o", file("x_%d.ply"), "--frames", "0.5"}, 2, {"0.5", "whole frames"});
    expect_refused({"export", scene, "-o", file("x.glb"), "--resume"}, 2, {"--resume"});
    expect_refused({"export", scene, "-o", file("x_%d.ply"), "--iso", "0.5"}, 2, {"--iso", "--as splats"});
    expect_refused({"export", file("none.nvv"), "-o", file("x.glb")}, 2, {"none.nvv"});
    expect_refused({"export", scene, "--as", "layout", "-o", file("x.usda")}, 2, {"is no stage", "neuvv stage new"});
    std::filesystem::create_hard_link(scene, file("same.ply"));
    expect_refused({"export", scene, "-o", file("same.ply"), "--frames", "0"}, 2, {"same.ply", "is to be exported"});
}

struct CliStageSpace : CliExport {
    std::string show = file("show.gltf");
    void SetUp() override {
        CliExport::SetUp();
        ASSERT_EQ(run_neuvv({"stage", "new", show}).code, 0);
        ASSERT_EQ(run_neuvv({"stage", "add", show, scene, "--name", "anna", "--at", "1,2,3", "--turn", "0,90,0",
                             "--scale", "2", "--time", "freeze:1f"})
                      .code,
                  0);
    }
    // The colour of a splat in a direction, by the harmonics of 3D Gaussian Splatting.
    static glm::dvec3 colour(const reference::GaussianSplat& splat, const glm::dvec3& d) {
        constexpr double kC0 = 0.28209479177387814, kC1 = 0.4886025119029199;
        return kC0 * splat.sh[0] + kC1 * (-d.y * splat.sh[1] + d.z * splat.sh[2] - d.x * splat.sh[3]);
    }
};

TEST_F(CliStageSpace, PutsAPerformerWhereTheStageHasIt) {
    exported(scene, file("own.ply"), {"--frames", "1"});
    exported(show, file("staged_%d.ply"), {"--stage-space", "--frames", "0"});
    const auto own = reference::read_splats(file("own.ply")), staged = reference::read_splats(file("staged_0.ply"));
    ASSERT_EQ(own.size(), staged.size());
    const auto up = [](const glm::dvec3& p) { return glm::dvec3(-p.x, -p.y, p.z); };     // the file's +Y is down
    const auto turned = [](const glm::dvec3& p) { return glm::dvec3(p.z, p.y, -p.x); };  // by 90° about +Y
    for (size_t i = 0; i < own.size(); ++i) {
        const glm::dvec3 at = 2.0 * turned(up(own[i].position)) + glm::dvec3(1, 2, 3);
        EXPECT_LT(glm::distance(up(staged[i].position), at), 1e-4);
        EXPECT_NEAR(staged[i].scale.x, 2 * own[i].scale.x, 0.1 * own[i].scale.x);
        EXPECT_NEAR(staged[i].opacity, own[i].opacity, 0.05);
        for (const glm::dvec3 d : {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}})
            EXPECT_LT(glm::distance(colour(staged[i], up(turned(d))), colour(own[i], up(d))), 0.01);
    }
}

TEST_F(CliStageSpace, NamesAFileForEachPerformer) {
    ASSERT_EQ(run_neuvv({"stage", "add", show, scene, "--name", "ben", "--visible", "off"}).code, 0);
    const std::vector<std::string> some = {"--stage-space", "--frames", "0"};
    const nlohmann::json both = exported(show, file("{performer}.ply"), some);
    ASSERT_EQ(both.size(), 2u);
    EXPECT_EQ(both[0].at("output"), file("anna.ply"));
    EXPECT_GT(both[0].at("splats"), 100);
    EXPECT_EQ(both[1].at("output"), file("ben.ply"));
    EXPECT_EQ(both[1].at("splats"), 0) << "ben is hidden";
    expect_refused({"export", show, "-o", file("x.ply"), "--stage-space", "--frames", "0"}, 2, {"--performer", "ben"});
    expect_refused({"export", scene, "-o", file("x.ply"), "--stage-space", "--frames", "0"}, 2, {"--stage-space"});
}

TEST_F(CliStageSpace, StandInsShowPerformersToOtherPrograms) {
    ASSERT_EQ(run_neuvv({"stage", "add", show, scene, "--name", "ben", "--visible", "off"}).code, 0);
    for (const char* name : {"carl", "dora"})
        ASSERT_EQ(run_neuvv({"stage", "add", show, scene, "--name", name, "--spin", "90"}).code, 0);
    const nlohmann::json made =
        exported(show, file("out.glb"), {"--as", "stand-ins", "--time", "1", "--most-splats", "500"});
    ASSERT_EQ(made.at("performers").size(), 3u) << "ben is hidden";
    EXPECT_EQ(made["performers"][0].at("frame"), 1) << "anna stands still";
    EXPECT_EQ(made["performers"][1].at("frame"), 2) << "of two a second";
    EXPECT_GT(made["performers"][0].at("psnr_db"), 15);
    EXPECT_LE(made["performers"][0].at("splats"), 500);
    EXPECT_GT(made["performers"][0].at("splats"), 400);
    const stage::Stage before = stage::load_stage(show), after = stage::load_stage(file("out.glb"));
    EXPECT_EQ(after.scene.meshes.size(), before.scene.meshes.size() + 2) << "carl and dora have the same splats";
    const stage::GltfNode& dora = after.scene.nodes.at(after.scene.nodes.at(after.performers[3].node).children.at(0));
    EXPECT_EQ(dora.name, "dora stand-in");
    EXPECT_NEAR(dora.rotation.y, std::sqrt(0.5), 1e-6) << "turned by 90°";
    for (const std::string& stage : {show, file("out.glb")})
        ASSERT_EQ(
            run_neuvv({"render", "--overwrite", stage, "-o", stage + ".png", "--time", "1", "--size", "96x64"}).code,
            0);
    EXPECT_EQ(read_text(show + ".png"), read_text(file("out.glb.png"))) << "this program shows the clips";
    EXPECT_EQ(run_neuvv({"stage", "remove", file("out.glb"), "dora"}).code, 0);
    const stage::Stage without = stage::load_stage(file("out.glb"));
    EXPECT_EQ(without.scene.nodes.size(), after.scene.nodes.size() - 2) << "her stand-in went with her";
    EXPECT_EQ(without.scene.meshes.size(), after.scene.meshes.size()) << "carl still has the splats";
    expect_refused({"export", file("out.glb"), "--as", "stand-ins", "-o", file("x.glb")}, 2, {"stand-ins already"});
    expect_refused({"export", show, "--as", "stand-ins", "-o", file("x.glb"), "--frames", "0"}, 2, {"--frames"});
    for (const char* name : {"anna", "carl", "dora"})
        ASSERT_EQ(run_neuvv({"stage", "set", show, name, "--visible", "off"}).code, 0);
    expect_refused({"export", show, "--as", "stand-ins", "-o", file("x.glb")}, 2, {"no performer", "ben is hidden"});
}

TEST_F(CliStageSpace, RefusesWhatAKindCannotKeep) {
    const ProgramResult plenoctree =
        run_neuvv({"export", "--overwrite", show, "-o", file("x.npz"), "--stage-space", "--frames", "0"});
    EXPECT_EQ(plenoctree.code, 2);
    EXPECT_NE(plenoctree.err.find("turned, which no PlenOctree can be"), std::string::npos) << plenoctree.err;
    ASSERT_EQ(run_neuvv({"stage", "set", show, "anna", "--scale", "1,2,1"}).code, 0);
    expect_refused({"export", show, "-o", file("x.ply"), "--stage-space", "--frames", "0"}, 2, {"anna", "stretched"});
}

// An opaque, grey ball that two frames show.
struct CliMesh : CliExported {
    void SetUp() override {
        std::vector<voctree::LeafPosition> positions;
        for (uint32_t i = 0; i < 32 * 32 * 32; ++i) {
            const glm::uvec3 cell(i % 32, i / 32 % 32, i / 1024);
            if (glm::distance(glm::vec3(cell) + 0.5f, glm::vec3(16)) < 12)
                positions.push_back({cell.x, cell.y, cell.z, 5});
        }
        tree = {};
        tree.node_levels = 3;
        tree.bases = 1;
        tree.hh_degree = 0;
        tree.frames = 2;
        tree.sigma_basis = {1, 1};
        tree.gamma_basis = {0, 0};
        voctree::build_topology(tree, positions);
        for (uint32_t i = 0; i < tree.leaf_count; ++i) tree.leaf(i)[0] = 1e4f;
        CliGpu::SetUp();
    }
};

TEST_F(CliMesh, ObjHasATextureAndSaysItsLoss) {
    const nlohmann::json json = exported(scene, file("m_%02d.obj"), {"--most-triangles", "1000", "--texture", "128"});
    EXPECT_EQ(json.at("files"), 6);
    EXPECT_LE(json.at("triangles"), 2000);
    EXPECT_GT(json.at("triangles"), 1900);
    EXPECT_GT(json.at("iou"), 0.96);
    EXPECT_LT(json.at("depth_mean_mm"), 15) << "half of a leaf";
    EXPECT_GT(json.at("psnr_db"), 25);
    uint64_t bytes = 0;
    for (const char* name : {"m_00.obj", "m_00.mtl", "m_00_texture.png", "m_01.obj", "m_01.mtl", "m_01_texture.png"})
        bytes += std::filesystem::file_size(file(name));
    EXPECT_EQ(json.at("bytes"), bytes);
    EXPECT_EQ(media::read_png(file("m_01_texture.png")).width, 128u);
}

TEST_F(CliMesh, IsPutWhereTheStageHasIt) {
    const std::string show = file("show.gltf");
    ASSERT_EQ(run_neuvv({"stage", "new", show}).code, 0);
    ASSERT_EQ(run_neuvv({"stage", "add", show, scene, "--at", "5,0,0", "--turn", "0,90,0", "--scale", "2"}).code, 0);
    const auto box_of = [&](const std::string& from, const std::vector<std::string>& more) {
        exported(from, file("m.obj"), more);
        std::istringstream text(read_text(file("m.obj")));
        std::string word;
        glm::dvec3 p, low(1e9), high(-1e9);
        while (text >> word)
            if (word == "v") {
                text >> p.x >> p.y >> p.z;
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
        return std::pair(low, high);
    };
    const auto [low, high] = box_of(scene, {"--frames", "0"});
    const auto [staged_low, staged_high] = box_of(show, {"--frames", "0", "--stage-space"});
    EXPECT_LT(glm::distance(staged_low, 2.0 * glm::dvec3(low.z, low.y, -high.x) + glm::dvec3(5, 0, 0)), 1e-3);
    EXPECT_LT(glm::distance(staged_high, 2.0 * glm::dvec3(high.z, high.y, -low.x) + glm::dvec3(5, 0, 0)), 1e-3);
}

TEST_F(CliMesh, GlbIsDrawnAsScenery) {
    EXPECT_EQ(exported(scene, file("m.glb"), {"--as", "mesh", "--texture", "128"}).at("files"), 1);
    const ProgramResult run =
        run_neuvv({"render", "--overwrite", file("m.glb"), "-o", file("m.png"), "--time", "0", "--size", "96x96"});
    ASSERT_EQ(run.code, 0) << run.err;
    const media::Image image = media::read_png(file("m.png"));
    int grey = 0;
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        if (std::abs(image.rgba[i] - 188) <= 2 && image.rgba[i] == image.rgba[i + 2]) ++grey;  // 0.5 of linear light
    EXPECT_GT(grey, 100);
}

TEST_F(CliMesh, PlyHasFacesOnlyWhereAMeshIsMeant) {
    exported(scene, file("mesh.ply"), {"--as", "mesh", "--frames", "0"});
    exported(scene, file("splats.ply"), {"--frames", "0"});
    const auto has_faces = [&](const char* name) {
        return read_text(file(name)).find("element face") != std::string::npos;
    };
    EXPECT_TRUE(has_faces("mesh.ply"));
    EXPECT_FALSE(has_faces("splats.ply"));
}

TEST_F(CliExport, MeshesSayWhatIsWrong) {
    expect_refused({"export", scene, "-o", file("x.usda"), "--as", "mesh"}, 2, {"x.usda", ".obj, .glb, .ply"});
    expect_refused({"export", scene, "-o", file("x.obj")}, 2, {"x.obj", "holds one frame, not 4", "out_%04d.obj"});
}

}  // namespace
}  // namespace neuvv
