// neuvv export: writes frames of a clip, or of a performer of a stage with its paint, for other programs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.h"
#include "base/formats/json.h"
#include "editor/open_file.h"
#include "tools/export/export_run.h"
#include "tools/export/stage_kinds.h"
#include "tools/say.h"
#include "tools/stage/stage_verbs.h"

namespace neuvv::tools {

namespace {

// As what a frame is written: --as. Where two kinds have the same ending, the first one is meant.
struct Kind {
    const char* name;
    std::vector<std::string> endings;
    std::vector<std::string> options;  // beside those of all frames
    std::unique_ptr<FrameExport> (*begin)(const ExportOptions& options, const std::string& ending, ExportedClip& clip,
                                          const CommonOptions& common);
};

const std::array kKinds = {
    Kind{"splats", {".ply", ".glb", ".usda"}, {"--most-splats"}, export_splats},
    Kind{"mesh",
         {".obj", ".glb", ".ply"},
         {"--opacity", "--most-triangles", "--smallest-part", "--texture"},
         export_meshes},
    Kind{"plenoctree", {".npz"}, {}, export_plenoctree},
    Kind{"volumes", {".vdb"}, {"--iso"}, export_volumes},
};
constexpr const char* kPerformerPlace = "{performer}";
const std::vector<std::string> kFrameOptions = {"--performer", "--stage-space", "--frames", "--fps",
                                                "--views",     "--size",        "--up",     "--resume"};

std::vector<std::string> kind_names() {
    std::vector<std::string> names;
    for (const Kind& kind : kKinds) names.emplace_back(kind.name);
    for (const StageKind& kind : stage_kinds()) names.emplace_back(kind.name);
    return names;
}

// Throws InputError where no kind, or not that of --as, has the output's ending.
const Kind& kind_of(const ExportOptions& options) {
    const std::string ending = std::filesystem::path(options.output).extension().string();
    std::vector<std::string> endings;
    for (const Kind& kind : kKinds) {
        if (!options.kind.empty() && options.kind != kind.name) continue;
        if (std::find(kind.endings.begin(), kind.endings.end(), ending) != kind.endings.end()) return kind;
        for (const std::string& known : kind.endings)
            if (std::find(endings.begin(), endings.end(), known) == endings.end()) endings.push_back(known);
    }
    throw InputError("--output", options.output, fmt::format("does not end with one of {}", fmt::join(endings, ", ")),
                     fmt::format("name it so, as in out_%04d{}", endings[0]));
}

// The kind of --as, where it is one of whole stages. Throws InputError where the output has another ending.
const StageKind* stage_kind_of(const ExportOptions& options) {
    const std::string ending = std::filesystem::path(options.output).extension().string();
    for (const StageKind& kind : stage_kinds()) {
        if (options.kind != kind.name) continue;
        if (kind.endings.empty()) return &kind;
        if (std::find(kind.endings.begin(), kind.endings.end(), ending) != kind.endings.end()) return &kind;
        throw InputError("--output", options.output,
                         fmt::format("does not end with {}", fmt::join(kind.endings, " or ")),
                         fmt::format("name it so, as in {}{}", kind.name, kind.endings[0]));
    }
    return nullptr;
}

// Throws InputError where the user gave an option of other kinds, which would do nothing.
void expect_options_of(const Command& verb, const std::string& kind, const std::vector<std::string>& own) {
    std::vector<std::string> all = kFrameOptions;
    for (const Kind& other : kKinds) all.insert(all.end(), other.options.begin(), other.options.end());
    for (const StageKind& other : stage_kinds()) all.insert(all.end(), other.options.begin(), other.options.end());
    for (const std::string& option : all)
        if (verb.count(option) > 0 && std::find(own.begin(), own.end(), option) == own.end())
            throw InputError(option, "", fmt::format("does nothing for --as {}", kind), "leave it out");
}

void write_stage(const ExportOptions& options, const StageKind& kind, const CommonOptions& common) {
    if (!editor::has_stage_ending(options.scene))
        throw InputError("scene", options.scene, fmt::format("is no stage, of which --as {} is made", kind.name),
                         "make one of a clip: neuvv stage new SHOW.gltf, neuvv stage add SHOW.gltf CLIP");
    if (NumberedPath::parse_output("--output", options.output))
        throw InputError(
            "--output", options.output,
            kind.endings.empty() ? "is a folder, without a frame's number" : "is one file without a frame's number",
            "leave the % out");
    nlohmann::ordered_json json = {{"output", options.output}, {"files", 1}, {"bytes", 0}};
    const std::string text = kind.write(options, common, json);
    if (!kind.endings.empty()) json["bytes"] = std::filesystem::file_size(options.output);
    if (options.json)
        tell("{}", json_text(json));
    else
        tell("{}: {}, {}\n", options.output, size_text(json["bytes"].get<uint64_t>()), text);
}

// What --json prints of one clip, or of one performer; nothing where it was printed for people.
std::optional<nlohmann::ordered_json> export_performer(const ExportOptions& options, PublishedScene scene,
                                                       const Kind& kind, const CommonOptions& common) {
    ExportedClip clip(std::move(scene), options.fps, options.stage_space);
    const std::string ending = std::filesystem::path(options.output).extension().string();
    const std::unique_ptr<FrameExport> frames = kind.begin(options, ending, clip, common);
    ExportRun run(options, clip, *frames);
    run.run();
    if (!options.json) {
        tell("{}: {} in {} files, {}\n", options.output, size_text(run.bytes()), run.files(), frames->summary());
        return std::nullopt;
    }
    nlohmann::ordered_json json = {{"output", options.output}, {"files", run.files()}, {"bytes", run.bytes()}};
    frames->report(json);
    return json;
}

// A performer's name as a part of a file's name, with its node where another performer has the same name.
std::string file_name_of(const stage::StagePerformer& performer, const stage::Stage& stage) {
    std::string name = performer.name;
    const auto same = std::count_if(stage.performers.begin(), stage.performers.end(),
                                    [&](const stage::StagePerformer& other) { return other.name == name; });
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '/' || c == '%'; }, '_');
    if (same > 1 || name != performer.name) name += fmt::format("_{}", performer.node);
    return name;
}

void run(const Command& verb, ExportOptions& options, const CommonOptions& common) {
    std::error_code error;
    if (std::filesystem::equivalent(options.scene, options.output, error))
        throw InputError("--output", options.output, "is what is to be exported", "choose another name");
    if (const StageKind* stage = stage_kind_of(options)) {
        expect_options_of(verb, stage->name, stage->options);
        return write_stage(options, *stage, common);
    }
    const Kind& kind = kind_of(options);
    std::vector<std::string> own = kFrameOptions;
    own.insert(own.end(), kind.options.begin(), kind.options.end());
    expect_options_of(verb, kind.name, own);
    if (options.size.empty()) options.size = kFrameSize;
    const size_t place = options.output.find(kPerformerPlace);
    if (place == std::string::npos) {
        if (options.stage_space) expect_stage_name("--stage-space", options.scene);
        const std::optional<nlohmann::ordered_json> json =
            export_performer(options, read_published_scene(options.scene, options.performer, options.up), kind, common);
        if (json) tell("{}", json_text(*json));
        return;
    }
    expect_stage_name("--output", options.scene);
    if (!options.performer.empty())
        throw InputError("--performer", options.performer, "is one of those that the output names",
                         fmt::format("leave it out, or {} in --output", kPerformerPlace));
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    const auto stage = std::make_shared<const stage::Stage>(stage::load_stage(options.scene));
    for (uint32_t i = 0; i < stage->performers.size(); ++i) {
        ExportOptions one = options;
        one.output.replace(place, std::string(kPerformerPlace).size(), file_name_of(stage->performers[i], *stage));
        const std::optional<nlohmann::ordered_json> json =
            export_performer(one, published_performer(stage, i), kind, common);
        if (json) all.push_back(*json);
    }
    if (options.json) tell("{}", json_text(all));
}

constexpr const char* kKindsHelp =
    "Each leaf becomes a splat of its size, and all of them get the width and the density for which images of the "
    "middle\nframe are most like the clip's. Colours are sRGB with spherical harmonics of the clip's degree.\n"
    ".ply is that of 3D Gaussian Splatting, with +Y down, which viewers turn up by half a turn about z. .glb is "
    "glTF with\nKHR_gaussian_splatting; where it holds several frames, an animation shows one after the other. "
    ".usda is OpenUSD's\nParticleField3DGaussianSplat (26.03 and later) with time samples.\n\n"
    "--as mesh: a closed surface around what images show, where a ray gets half of its opacity, and a texture of "
    "the clip's own\ncolours, as seen along the surface's normal: how they change with direction is lost. .glb is "
    "unlit glTF; .obj has a .mtl and\na _texture.png beside it; .ply has colours of vertices. The loss is measured on "
    "the "
    "middle frame: how well silhouettes agree (iou),\ndepth, PSNR.\n\n"
    ".npz is a PlenOctree, as svox and volrend read it, with the clip's leaves and +Z up. Colours are fitted to "
    "sRGB.\n\n"
    ".vdb is OpenVDB's, in metres with +Y up: \"density\" in 1/m, and \"Cd\", the mean of a leaf's colour over "
    "all directions, in\nlinear light.\n\n"
    "A stage's camera becomes what --as says: camera is a .usda or an animated .glb, nerfstudio and instant-ngp "
    "are the camera\npaths of those programs. layout is a .usda of where performers, lights and cameras are, and "
    "when.\n\n"
    "--as stand-ins: the stage as one .glb for programs that know no clips. Below each performer's node are splats of "
    "what it shows\nat --time, so that programs with KHR_gaussian_splatting show the whole stage, and others coloured "
    "points. In this program, it is\nthe stage with its clips, as before.\n\n"
    "--as web: a folder for any file server that answers ranges, with a page that plays the stage. Clips become "
    "streams "
    "as by\nneuvv publish, with their visible paint; what is a stream is copied. The output says what browsers leave "
    "out. It takes the player\nthat `tools/web/build build/web node_modules/three` has made, after `npm install "
    "three`.\n";

void add_frame_options(const Command& verb, ExportOptions& options) {
    verb.add_option("--performer", options.performer,
                    "Of a stage: which, by its name or index; may be left out where there is one");
    verb.add_flag(
        "--stage-space", options.stage_space,
        "Of a stage: put the performer where the stage has it, frame by frame, turned, scaled, by its time map "
        "and not while\nit is hidden; lights and opacity are left out. --frames and --fps are then the "
        "stage's, and files are numbered from its\nbeginning");
    verb.add_option("--frames", options.frames, "FIRST:LAST of the clip as it was recorded (all)");
    verb.add_option("--fps", options.fps,
                    "Frames a second (those of the clip, or of the stage of which a camera or the layout is written). "
                    "Files are numbered at this\nrate from the clip's beginning. What lies between two recorded frames "
                    "is mixed, as in slow "
                    "motion; of a .nvs, it is the nearer one")
        .number_between(0.01, 1e4);
    verb.add_option("--most-splats", options.most_splats,
                    "Of each frame: what agrees best is merged (0: no limit; stand-ins have 50000)");
    verb.add_option("--opacity", options.mesh.opacity, "Of meshes: what a ray gets where the surface is")
        .number_between(0.01, 0.99)
        .show_default();
    verb.add_option("--most-triangles", options.mesh.most_triangles, "Of each mesh; 0: no limit").show_default();
    verb.add_option("--smallest-part", options.mesh.smallest_part,
                    "Parts of meshes that are smaller are dropped, 1 being the largest part's size")
        .number_between(0, 1)
        .show_default();
    verb.add_option("--texture", options.mesh.texture_px, "The side of textures of meshes, pixels")
        .in_range(64, 8192)
        .show_default();
    verb.add_option(
            "--iso", options.iso,
            "Of a .vdb: write a level set, too, of the surface where the opacity along a voxel falls below this")
        .number_between(0.001, 0.999);
    verb.add_option("--views", options.views, "Images of the middle frame by which the loss is measured")
        .in_range(2, 100)
        .show_default();
    verb.add_option("--size", options.size,
                    "WIDTHxHEIGHT of these images and of the close-ups by which splats get their shape (720x720); of a "
                    "stage's camera: of its "
                    "images (1280x720)");
    add_up_option(verb, options.up);
    verb.add_flag("--resume", options.resume,
                  "Keep the numbered files that are there; give the same other options as before");
}

void add_stage_options(const Command& verb, ExportOptions& options) {
    verb.add_option(
        "--camera", options.camera,
        "Of a stage's camera kinds: path (the stage's own, and the default where it has one), a camera's name "
        "or index, or a file with a camera path");
    verb.add_option(
        "--world", options.world,
        "Of those: nerfstudio's dataparser_transforms.json, or the transforms.json of instant-ngp's data set");
    verb.add_option("--splats", options.splats,
                    "Of the kind layout: a folder with the splats of performers, NAME.usda, to which it refers");
    verb.add_option("--time", options.time_s,
                    "Of stand-ins: the recorded frames nearest to what performers show at this time of the stage, "
                    "seconds")
        .number_between(0, 1e6)
        .show_default();
    add_encoding_options(verb, options.encoding);
}

}  // namespace

void add_export(Command app, CommonOptions& common) {
    Command verb = app.add_verb("export",
                                "Write frames of a clip as splats, meshes, volumes or PlenOctrees, or a stage's "
                                "cameras and layout, for other programs");
    const auto options = std::make_shared<ExportOptions>();
    verb.add_option("scene", options->scene,
                    "The .nvv, in segments or not, the .nvs, the .npz of a PlenOctree, or a stage, .gltf or .glb")
        .required();
    verb.add_option(
            "-o,--output", options->output,
            "out_%04d.ply, .glb, .usda, .obj, .npz or .vdb for a file each frame; a .glb or .usda may hold them all. "
            "Of a stage, {performer} in the name stands for each performer's own: all of them are written. Of a "
            "stage's "
            "cameras and layout, see --as: one .usda, .glb or .json; for --as web a folder")
        .required();
    verb.add_option(
            "--as", options->kind,
            "What each frame becomes; without it, the first that has the ending. Of a stage also what its camera "
            "becomes, see below")
        .one_of(kind_names());
    add_frame_options(verb, *options);
    add_stage_options(verb, *options);
    verb.add_flag(
        "--json", options->json,
        "Print JSON: output, files, bytes, and what the kind says; of splats: splats, psnr_db,\n"
        "close_psnr_db (of the four close-ups that width and density were fitted to), width, density;\n"
        "of meshes: triangles, iou, depth_mean_mm, depth_95_mm, psnr_db; of volumes: leaves, voxel_m, psnr_db; of\n"
        "PlenOctrees: leaves, psnr_db; of stand-ins: performers, a list of performer, frame, splats, and the losses of "
        "those\n"
        "that gave the splats of this clip their shape; of web: page, left_out");
    verb.footer({kKindsHelp, kDeviceHelp, kExamplesHead,
                 "  neuvv export work/performer.nvv -o work/splats/frame_%04d.ply --frames 0:4\n"
                 "  neuvv export work/performer.nvv -o work/performer.glb --frames 0:4 --most-splats 20000\n"
                 "  neuvv export work/performer.nvv -o work/performer.usda --frames 0 --most-splats 20000\n"
                 "  neuvv export work/performer.nvv -o work/slow/frame_%04d.ply --frames 0:1 --fps 50\n"
                 "  neuvv export work/performer.nvv -o work/mesh_%04d.obj --frames 0:1\n"
                 "  neuvv export work/performer.nvv -o work/meshes.glb --as mesh --frames 0:1 --most-triangles 20000\n"
                 "  neuvv export work/performer.nvv -o work/volume/frame_%04d.vdb --frames 0:2 --iso 0.5\n"
                 "  neuvv export work/show.gltf --stage-space -o 'work/{performer}_%04d.ply' --frames 0:4\n"
                 "  neuvv export work/show.gltf --as nerfstudio -o work/camera_path.json\n"
                 "  neuvv export work/show.gltf --as layout -o work/show.usda\n"
                 "  neuvv export work/show.gltf --as stand-ins -o work/show_splats.glb\n"
                 "  neuvv export work/show.gltf --as web -o work/show_web"});
    verb.callback([options, verb, &common] { run(verb, *options, common); });
}

}  // namespace neuvv::tools
