// neuvv import: makes a clip of volumes or Gaussian splats that other programs wrote.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/numbered_path.h"
#include "base/platform.h"
#include "media/psnr.h"
#include "tools/commands.h"
#include "tools/compared_views.h"
#include "tools/data/imported_frame.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/unfinished_clip.h"
#include "voctree/coarse.h"
#include "voctree/files/clip_index.h"
#include "voctree/files/nvv.h"

namespace neuvv::tools {

namespace {

constexpr size_t kMostDigits = 9;  // of a frame's number
constexpr size_t kMostSaid = 10;   // notes on stderr

// What is said about the frames: each text once, as many frames have the same.
class Notes {
  public:
    void add(const std::string& file, const std::string& text) {
        if (!texts_.insert(text).second) return;
        notes_.push_back(file + ": " + text);
        if (notes_.size() <= kMostSaid) say("{}\n", notes_.back());
    }
    void finish() const {
        if (notes_.size() > kMostSaid)
            say("{} more such notes about other frames; --json has all\n", notes_.size() - kMostSaid);
    }
    const std::vector<std::string>& all() const { return notes_; }

  private:
    std::set<std::string> texts_;
    std::vector<std::string> notes_;
};

// The files of a numbered path, by their numbers, of which none may be missing; or the one file.
std::vector<std::filesystem::path> files_of(const std::string& input) {
    const std::filesystem::path path(input), folder = path.parent_path();
    const std::string name = path.filename().string();
    const auto numbered = NumberedPath::parse(name);
    std::error_code error;
    if (!numbered || std::filesystem::is_regular_file(path, error)) return {input};
    const size_t before = numbered->before().size(), others = numbered->file("").size();  // characters
    std::vector<uint64_t> numbers;
    for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder, error)) {
        const std::string found = entry.path().filename().string();
        if (found.size() <= others || found.size() > others + kMostDigits) continue;
        const std::string number = found.substr(before, found.size() - others);
        if (number.find_first_not_of("0123456789") != std::string::npos) continue;
        if (numbered->file(std::stoull(number)) == found) numbers.push_back(std::stoull(number));
    }
    std::sort(numbers.begin(), numbers.end());
    if (numbers.empty()) throw InputError(input, "", "names no file that is there");
    std::vector<std::filesystem::path> files;
    for (size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] != numbers[0] + i)
            throw InputError((folder / numbered->file(numbers[0] + i)).string(), "", "is missing among the frames",
                             "number them without gaps");
        files.push_back(folder / numbered->file(numbers[i]));
    }
    return files;
}

struct Imported {
    uint64_t frames = 0, leaves = 0, bytes = 0;
    std::optional<double> psnr, worst_psnr;  // of images of the middle frame
    uint32_t empty_views = 0;                // of these images, that show nothing
    Notes notes;
};

// The background on which what was read can be seen: white, or black where it is white itself.
std::optional<glm::vec3> telling_background(const ImportedFrame& frame, const stage::Camera& camera,
                                            media::Image& image) {
    for (const glm::vec3& background : {glm::vec3(1), glm::vec3(0)}) {
        image = frame.image(camera, background);
        if (shows_something(image, background)) return background;
    }
    return std::nullopt;
}

// How well the clip's images of a frame agree with those of what was read. An image that shows nothing tells nothing.
void compare(const gpu::Device& device, const ImportedFrame& frame, const voctree::VOctree& tree,
             const FrameImportOptions& options, Imported& imported) {
    if (tree.leaf_count == 0) return;
    const ComparedViews views(device, tree, parse_size(options.size), options.views);
    std::vector<double> psnrs;
    for (size_t i = 0; i < views.count(); ++i) {
        expect_to_go_on(options.output);
        media::Image truth;
        const auto background = telling_background(frame, views.camera_of(i), truth);
        if (background)
            psnrs.push_back(media::psnr_db(truth, views.render_still(tree, i, *background)));
        else
            ++imported.empty_views;
    }
    if (psnrs.empty()) return;
    imported.psnr = psnr_together(psnrs);
    imported.worst_psnr = *std::ranges::min_element(psnrs);
}

Imported import_frames(const FrameImportOptions& options, const CommonOptions& common) {
    const std::unique_ptr<FrameImport> import = import_of(options);
    const std::vector<std::filesystem::path> files = files_of(options.input);
    if (files.size() > voctree::kMaxClipFrames)
        throw InputError(options.input, "", "has too many frames", "import a part of them");
    catch_stop_signals();
    const UnfinishedClip clip(options.output);
    const gpu::Device device(common.device);
    Progress progress("import", files.size());
    Imported imported;
    EmptyFrame empty;
    voctree::ClipIndex index;
    index.fps = static_cast<float>(options.fps);
    for (uint32_t i = 0; i < files.size(); ++i) {
        expect_to_go_on(options.output);
        const std::unique_ptr<ImportedFrame> frame = import->read(files[i]);
        for (const std::string& note : frame->notes()) imported.notes.add(files[i].string(), note);
        const voctree::VOctree tree = frame->tree();
        if (tree.leaf_count == 0) {
            const EmptyFrame reason = frame->why_empty();
            if (empty.problem.empty()) empty = reason;
            if (files.size() == 1) throw InputError(options.input, "", empty.problem, empty.fix);
            imported.notes.add(files[i].string(), "the frame shows nothing: it " + reason.problem);
        }
        const std::filesystem::path file = clip.folder() / voctree::segment_file_name(i);
        voctree::write_nvv(file, tree, {}, 9, voctree::coarse_tree(tree));
        index.segments.push_back({file, i, 1});
        ++imported.frames;
        imported.leaves += tree.leaf_count;
        imported.bytes += std::filesystem::file_size(file);
        if (i == files.size() / 2) compare(device, *frame, tree, options, imported);
        progress.update(i + 1, fmt::format("{} leaves", tree.leaf_count));
    }
    progress.finish();
    imported.notes.finish();
    if (imported.leaves == 0) throw InputError(options.input, "", empty.problem, empty.fix);
    if (files.size() == 1) {
        clip.finish(index.segments[0].file);
    } else {
        voctree::write_clip_index(clip.folder(), index);
        clip.finish(clip.folder());
    }
    return imported;
}

// How well a stream keeps the clip is chosen when it is published, which needs the clip.
void expect_no_stream_output(const FrameImportOptions& options) {
    const std::filesystem::path output(options.output);
    if (output.extension() != ".nvs") return;
    const std::string clip = std::filesystem::path(output).replace_extension(".nvv").string();
    throw InputError("--output", options.output, "is a stream, which is made of a clip",
                     fmt::format("run `neuvv import {} -o {}`, then `neuvv publish {} -o {}`", options.input, clip,
                                 clip, options.output));
}

void run(const FrameImportOptions& options, const CommonOptions& common) {
    expect_no_stream_output(options);
    const Imported imported = import_frames(options, common);
    if (options.json) {
        nlohmann::ordered_json json = {{"input", options.input},
                                       {"output", options.output},
                                       {"frames", imported.frames},
                                       {"leaves", imported.leaves},
                                       {"bytes", imported.bytes}};
        if (imported.psnr) json["psnr_db"] = *imported.psnr;
        if (imported.psnr) json["worst_psnr_db"] = *imported.worst_psnr;
        json["empty_views"] = imported.empty_views;
        json["notes"] = imported.notes.all();
        tell("{}", json_text(json));
        return;
    }
    tell("{}: {} for {} frames at {:.6g} fps, {} leaves", options.output, size_text(imported.bytes), imported.frames,
         options.fps, imported.leaves);
    if (imported.psnr)
        tell("; images of the middle frame have {:.1f} dB, the worst {:.1f}", *imported.psnr, *imported.worst_psnr);
    if (imported.empty_views > 0)
        tell("; {} of {} images of it show nothing and were not compared", imported.empty_views, options.views);
    tell("\n");
}

}  // namespace

void add_import(Command app, CommonOptions& common) {
    Command verb = app.add_verb("import", "Make a clip of volumes or Gaussian splats of other programs");
    const auto options = std::make_shared<FrameImportOptions>();
    verb.add_option("input", options->input, "in_%04d.vdb or in_%04d.ply, or one such file").required();
    verb.add_option("-o,--output", options->output,
                    "The .nvv to write: a file, or a folder where there are more frames")
        .required();
    verb.add_option("--resolution", options->resolution,
                    "Cells along the longest side of the first frame; of volumes, at most so many, as voxels are never "
                    "divided")
        .in_range(8u, 2048u)
        .show_default();
    add_choice(verb, "--up", options->up, std::span<const char* const>(kUpNames),
               "The axis of the files that is up (default: y of a .vdb, z of one by Blender, -y of a .ply)");
    verb.add_option("--scale", options->scale, "Metres that the files' unit of length is")
        .number_between(1e-6, 1e6)
        .show_default();
    verb.add_option(
        "--box", options->box,
        "Of splats: x0,y0,z0,x1,y1,z1 in metres, +Y up; all outside is left out (default: around all splats but "
        "a few that float far away, which are named)");
    verb.add_option("--fps", options->fps, "Frames a second").number_between(0.01, 1000).show_default();
    verb.add_option("--views", options->views, "Images of the middle frame by which the loss is measured")
        .in_range(1, 100)
        .show_default();
    verb.add_option("--size", options->size, "WIDTHxHEIGHT of them").show_default();
    verb.add_flag("--json", options->json,
                  "Print JSON: frames, leaves, bytes, psnr_db, worst_psnr_db, empty_views, notes");
    verb.footer(
        {"A .vdb is OpenVDB's: its fog volume \"density\", per unit of length, and its vectors \"Cd\" or \"color\" in "
         "linear light;\nwithout them it is white. A .ply is that of 3D Gaussian Splatting. Each frame becomes a "
         "segment "
         "of its own, so that a\nstage can show it beside captured performers; `neuvv publish` makes a stream of it.\n"
         "PSNR compares the clip's images with those of the volume or the splats themselves, on white, or on black "
         "where these\nare white. Images that show nothing are not compared.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv export work/performer.nvv -o work/splats/frame_%04d.ply --frames 0:2\n"
         "  neuvv import work/splats/frame_%04d.ply -o work/splats.nvv\n"
         "  neuvv export work/performer.nvv -o work/volume/frame_%04d.vdb --frames 0:2\n"
         "  neuvv import work/volume/frame_%04d.vdb -o work/volume.nvv\n"
         "  neuvv publish work/volume.nvv -o work/volume.nvs"});
    verb.callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::tools
