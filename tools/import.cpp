// neuvv import: makes a clip of volumes or Gaussian splats that other programs wrote.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/json.h"
#include "base/numbered_path.h"
#include "base/platform.h"
#include "interchange/splat_image.h"
#include "interchange/splat_ply.h"
#include "interchange/vdb_volume.h"
#include "interchange/voxelise.h"
#include "tools/commands.h"
#include "tools/compared_views.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/unfinished_clip.h"
#include "training/evaluation/metrics.h"
#include "voctree/clip_index.h"
#include "voctree/coarse.h"
#include "voctree/nvv.h"

namespace neuvv::tools {

namespace {

enum class Up { kY, kMinusY, kZ };
constexpr size_t kMostDigits = 9;  // of a frame's number
constexpr const char* kUpNames[] = {"y", "-y", "z"};

struct FrameImportOptions {
    std::string input, output, box, size = "720x720";
    std::optional<Up> up;
    double scale = 1, fps = 25;
    uint32_t resolution = 256, views = 8;
    bool json = false;
};

// From the file's axes to ours.
glm::dquat rotation_of(Up up) {
    switch (up) {
        case Up::kY:
            break;
        case Up::kMinusY:
            return interchange::kPlyRotation;
        case Up::kZ:
            return glm::dquat(std::sqrt(0.5), -std::sqrt(0.5), 0, 0);  // (x, y, z) becomes (x, z, −y)
    }
    return {1, 0, 0, 0};
}

// A frame as it was read.
class ImportedFrame {
  public:
    virtual ~ImportedFrame() = default;
    virtual voctree::VOctree tree() const = 0;
    // On white, drawn from what was read, without cells.
    virtual media::Image image(const stage::Camera& camera) const = 0;
};

// A kind of input. The first frame that shows something decides how large cells are in all of them.
class FrameImport {
  public:
    virtual ~FrameImport() = default;
    virtual std::unique_ptr<ImportedFrame> read(const std::filesystem::path& file) = 0;
};

void expect_to_go_on(const std::string& output) {
    if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", output));
}

class VolumeImport : public FrameImport {
  public:
    explicit VolumeImport(const FrameImportOptions& options) : options_(options) {
        if (!options.box.empty())
            throw InputError("--box", options.box, "is for splats",
                             "leave it out, or crop the volume where it is made");
    }
    std::unique_ptr<ImportedFrame> read(const std::filesystem::path& file) override {
        const glm::dmat4 turned = glm::mat4_cast(rotation_of(options_.up.value_or(Up::kY)));
        auto frame = std::make_unique<Frame>(options_.output);
        frame->volume = interchange::volume_of(interchange::read_vdb(file), file.string(),
                                               turned * glm::dmat4(glm::dmat3(options_.scale)));
        if (!doublings_) doublings_ = interchange::doublings_for(frame->volume, options_.resolution);
        frame->doublings = doublings_.value_or(0);
        frame->fps = static_cast<float>(options_.fps);
        return frame;
    }

  private:
    struct Frame : ImportedFrame {
        explicit Frame(const std::string& to) : output(to) {}
        voctree::VOctree tree() const override { return interchange::tree_of(volume, doublings, fps); }
        media::Image image(const stage::Camera& camera) const override {
            return interchange::vdb_image(volume, camera, [&] { expect_to_go_on(output); });
        }
        const std::string& output;
        interchange::VdbVolume volume;
        uint32_t doublings = 0;
        float fps = 25;
    };
    const FrameImportOptions& options_;
    std::optional<uint32_t> doublings_;
};

class SplatImport : public FrameImport {
  public:
    explicit SplatImport(const FrameImportOptions& options) : options_(options) {
        if (options.box.empty()) return;
        const std::vector<double> n = parse_numbers("--box", options.box, 6, "write x0,y0,z0,x1,y1,z1 in metres");
        box_ = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
        if (glm::any(glm::greaterThanEqual(box_->low, box_->high)))
            throw InputError("--box", options.box, "is empty", "write the least corner first");
    }
    std::unique_ptr<ImportedFrame> read(const std::filesystem::path& file) override {
        auto frame = std::make_unique<Frame>(options_);
        frame->file = file.string();
        interchange::PlySplats read = interchange::read_splat_ply(file, options_.scale);
        if (read.left_out > 0)
            say("{}: left out {} splats whose numbers are no numbers, too large, or no rotation\n", file.string(),
                read.left_out);
        frame->splats = std::move(read.splats);
        interchange::turn(frame->splats, rotation_of(options_.up.value_or(Up::kMinusY)));
        frame->box = box_ ? *box_ : interchange::box_of(frame->splats);
        const glm::dvec3 size = frame->box.high - frame->box.low;
        const double longest = std::max({size.x, size.y, size.z});
        if (!cell_m_ && longest > 0) cell_m_ = longest / options_.resolution;
        frame->cell_m = cell_m_.value_or(1);
        return frame;
    }

  private:
    struct Frame : ImportedFrame {
        explicit Frame(const FrameImportOptions& given) : options(given) {}
        voctree::VOctree tree() const override {
            return interchange::voxelised(splats, box, cell_m, static_cast<float>(options.fps), file,
                                          [&] { expect_to_go_on(options.output); });
        }
        media::Image image(const stage::Camera& camera) const override {
            return interchange::splat_image(splats, camera, glm::vec3(1));
        }
        const FrameImportOptions& options;
        std::string file;
        interchange::Splats splats;
        interchange::SplatBox box;
        double cell_m = 1;
    };
    const FrameImportOptions& options_;
    std::optional<interchange::SplatBox> box_;
    std::optional<double> cell_m_;
};

std::unique_ptr<FrameImport> import_of(const FrameImportOptions& options) {
    const std::string ending = std::filesystem::path(options.input).extension().string();
    if (ending == ".vdb") return std::make_unique<VolumeImport>(options);
    if (ending == ".ply") return std::make_unique<SplatImport>(options);
    throw InputError(options.input, "", "does not end with .vdb or .ply",
                     "name the frames as in in_%04d.vdb or in_%04d.ply");
}

// The files of a numbered path, by their numbers, of which none may be missing; or the one file.
std::vector<std::filesystem::path> files_of(const std::string& input) {
    const std::filesystem::path path(input), folder = path.parent_path();
    const std::string name = path.filename().string();
    const auto numbered = NumberedPath::parse(name);
    if (!numbered) return {input};
    const size_t before = name.rfind('%'), others = numbered->file("").size();  // characters
    std::vector<uint64_t> numbers;
    std::error_code error;
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
    for (size_t i = 0; i < numbers.size(); i++) {
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
};

// How well the clip's images of a frame agree with those of what was read.
void compare(const gpu::Device& device, const ImportedFrame& frame, const voctree::VOctree& tree,
             const FrameImportOptions& options, Imported& imported) {
    if (tree.leaf_count == 0) return;
    const ComparedViews views(device, tree, parse_size(options.size), options.views);
    std::vector<double> psnrs;
    for (size_t i = 0; i < views.count(); i++) {
        expect_to_go_on(options.output);
        psnrs.push_back(training::compare(frame.image(views.camera_of(i)), views.render_still(tree, i)).psnr);
    }
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
    voctree::ClipIndex index;
    index.fps = static_cast<float>(options.fps);
    for (uint32_t i = 0; i < files.size(); i++) {
        expect_to_go_on(options.output);
        const std::unique_ptr<ImportedFrame> frame = import->read(files[i]);
        const voctree::VOctree tree = frame->tree();
        const std::filesystem::path file = clip.folder() / voctree::segment_file_name(i);
        voctree::write_nvv(file, tree, {}, 9, voctree::coarse_tree(tree));
        index.segments.push_back({file, i, 1});
        imported.frames++;
        imported.leaves += tree.leaf_count;
        imported.bytes += std::filesystem::file_size(file);
        if (i == files.size() / 2) compare(device, *frame, tree, options, imported);
        progress.update(i + 1, fmt::format("{} leaves", tree.leaf_count));
    }
    progress.finish();
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
        fmt::print("{}", json_text(json));
        return;
    }
    fmt::print("{}: {} for {} frames at {:.6g} fps, {} leaves", options.output, size_text(imported.bytes),
               imported.frames, options.fps, imported.leaves);
    if (imported.psnr)
        fmt::print("; images of the middle frame have {:.1f} dB, the worst {:.1f}", *imported.psnr,
                   *imported.worst_psnr);
    fmt::print("\n");
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
               "The axis of the files that is up (default: y of a .vdb, -y of a .ply)");
    verb.add_option("--scale", options->scale, "Metres that the files' unit of length is")
        .number_between(1e-6, 1e6)
        .show_default();
    verb.add_option("--box", options->box, "Of splats: x0,y0,z0,x1,y1,z1 in metres, +Y up; all outside is left out");
    verb.add_option("--fps", options->fps, "Frames a second").number_between(0.01, 1000).show_default();
    verb.add_option("--views", options->views, "Images of the middle frame by which the loss is measured")
        .in_range(1, 100)
        .show_default();
    verb.add_option("--size", options->size, "WIDTHxHEIGHT of them").show_default();
    verb.add_flag("--json", options->json, "Print JSON: frames, leaves, bytes, psnr_db, worst_psnr_db");
    verb.footer(
        {"A .vdb is OpenVDB's: its fog volume \"density\", per unit of length, and its vectors \"Cd\" or \"color\" in "
         "linear light;\nwithout them it is white. A .ply is that of 3D Gaussian Splatting. Each frame becomes a "
         "segment "
         "of its own, so that a\nstage can show it beside captured performers; `neuvv publish` makes a stream of it.\n"
         "PSNR compares the clip's images with those of the volume or the splats themselves, on white.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv export work/performer.nvv -o work/splats/frame_%04d.ply --frames 0:2\n"
         "  neuvv import work/splats/frame_%04d.ply -o work/splats.nvv\n"
         "  neuvv export work/performer.nvv -o work/volume/frame_%04d.vdb --frames 0:2\n"
         "  neuvv import work/volume/frame_%04d.vdb -o work/volume.nvv\n"
         "  neuvv publish work/volume.nvv -o work/volume.nvs"});
    verb.callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::tools
