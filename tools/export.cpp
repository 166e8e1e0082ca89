// neuvv export: writes frames of a clip, or of a performer of a stage with its paint, as Gaussian splats for other
// programs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/json.h"
#include "base/numbered_path.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "interchange/fit_splats.h"
#include "interchange/shown_leaves.h"
#include "interchange/splat_gltf.h"
#include "interchange/splat_ply.h"
#include "interchange/splat_usd.h"
#include "tools/commands.h"
#include "tools/compared_views.h"
#include "tools/options.h"
#include "tools/published_scene.h"
#include "tools/report.h"
#include "voctree/clip.h"
#include "voctree/slice.h"

namespace neuvv::tools {

namespace {

struct ExportOptions {
    std::string scene, performer, output, frames, size = "720x720";
    uint32_t most_splats = 0, views = 8;
    std::optional<voctree::UpAxis> up;
    bool resume = false, json = false;
};

// A kind of file.
struct Format {
    const char* ending;
    glm::dquat rotation;  // of its axes from ours
    bool holds_many;      // frames in one file
    size_t (*bytes_of_splat)(uint32_t degree);
    void (*write)(const std::filesystem::path& file, std::span<const interchange::Splats> frames, double fps);
};

void write_ply(const std::filesystem::path& file, std::span<const interchange::Splats> frames, double) {
    interchange::write_splat_ply(file, frames[0]);
}

const std::array<Format, 3> kFormats = {{
    {".ply", interchange::kPlyRotation, false, interchange::ply_bytes_of_splat, write_ply},
    {".glb", glm::dquat(1, 0, 0, 0), true, interchange::glb_bytes_of_splat, interchange::write_splat_glb},
    {".usda", glm::dquat(1, 0, 0, 0), true, interchange::usda_bytes_of_splat, interchange::write_splat_usda},
}};

const Format& format_of(const std::string& output) {
    const std::string ending = std::filesystem::path(output).extension().string();
    for (const Format& format : kFormats)
        if (ending == format.ending) return format;
    throw InputError("--output", output, "does not end with .ply, .glb or .usda", "name it so, as in out_%04d.ply");
}

struct Exported {
    uint64_t files = 0, bytes = 0, splats = 0;  // those that were there already do not count
    std::optional<interchange::SplatFit> fit;   // none where the middle frame is empty
};

class Exporter {
  public:
    Exporter(const ExportOptions& options, const PublishedScene& scene, const CommonOptions& common);
    Exported run();

  private:
    // A segment with its paint, as long as frames of it are written.
    struct OpenSegment {
        OpenSegment(const PublishedScene& scene, const voctree::ClipSegment& segment)
            : from(segment), tree(voctree::read_segment(segment)), paint(read_segment_layers(scene, segment, tree)) {}
        voctree::ClipSegment from;
        voctree::VOctree tree;
        SegmentLayers paint;
    };
    OpenSegment& segment_of(uint32_t frame);
    interchange::FrameVolume volume_of(uint32_t frame);
    void fit_middle_frame();
    void expect_room(size_t splats, uint32_t degree) const;
    void write(const std::filesystem::path& file, std::span<const interchange::Splats> frames);
    void expect_to_go_on() const {
        if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", options_.output));
    }
    uint32_t frame_count() const { return last_ - first_ + 1; }

    const ExportOptions& options_;
    const PublishedScene& scene_;
    const Format& format_;
    std::optional<NumberedPath> numbered_;
    gpu::Device device_;
    uint32_t first_ = 0, last_ = 0;  // frames of the clip
    std::unique_ptr<OpenSegment> segment_;
    Exported exported_;
    Progress progress_{"export"};
};

Exporter::Exporter(const ExportOptions& options, const PublishedScene& scene, const CommonOptions& common)
    : options_(options),
      scene_(scene),
      format_(format_of(options.output)),
      numbered_(NumberedPath::parse(options.output)),
      device_(common.device) {
    const FrameRange range = parse_frame_range(options.frames, scene.index.frames());
    first_ = static_cast<uint32_t>(range.first);
    last_ = static_cast<uint32_t>(range.last);
    if (range.first != first_ || range.last != last_)
        throw InputError("--frames", options.frames, "lies between two frames", "write whole frames");
    if (options.output.find('%') != (numbered_ ? options.output.rfind('%') : std::string::npos))
        throw InputError("--output", options.output, "needs one place for the frame's number",
                         fmt::format("write it as in out_%04d{}", format_.ending));
    if (!numbered_ && !format_.holds_many && frame_count() > 1)
        throw InputError("--output", options.output, fmt::format("holds one frame, not {}", frame_count()),
                         fmt::format("write out_%04d{}, or choose --frames {}", format_.ending, first_));
    if (options.resume && !numbered_)
        throw InputError("--resume", options.output, "is one file, which is written at once", "leave it out");
    prepare_output_file("--output", numbered_ ? numbered_->file(uint64_t{first_}) : options.output);
}

Exporter::OpenSegment& Exporter::segment_of(uint32_t frame) {
    if (segment_ && frame >= segment_->from.first && frame < segment_->from.end()) return *segment_;
    segment_.reset();  // before the next one is read: together they may be too large
    for (const voctree::ClipSegment& segment : scene_.index.segments)
        if (frame >= segment.first && frame < segment.end()) segment_ = std::make_unique<OpenSegment>(scene_, segment);
    return *segment_;
}

interchange::FrameVolume Exporter::volume_of(uint32_t frame) {
    const OpenSegment& segment = segment_of(frame);
    interchange::FrameVolume volume =
        interchange::frame_volume(segment.tree, frame - segment.from.first, segment.paint.steps);
    if (options_.most_splats == 0 || volume.leaves.size() <= options_.most_splats) return volume;
    interchange::measure_shown(volume);
    return interchange::with_fewer_leaves(std::move(volume), options_.most_splats);
}

// Finds the shape of all splats by images of the middle frame.
void Exporter::fit_middle_frame() {
    const uint32_t frame = first_ + frame_count() / 2;
    const interchange::FrameVolume volume = volume_of(frame);
    expect_room(volume.leaves.size(), volume.degree);
    if (volume.leaves.empty()) return;
    const OpenSegment& segment = segment_of(frame);
    const voctree::VOctree still =
        voctree::tree_of(voctree::slice_of(segment.tree, frame - segment.from.first, segment.paint.steps),
                         segment.tree.box_min, segment.tree.box_size, segment.tree.fps);
    const ComparedViews compared(device_, still, parse_size(options_.size), options_.views);
    std::vector<interchange::FitView> views;
    for (size_t i = 0; i < compared.count(); i++)
        views.push_back({compared.camera_of(i), compared.render_still(still, i)});
    // Two views decide, all of them say what is lost.
    const std::vector<interchange::FitView> some = {views[0], views[views.size() / 2]};
    exported_.fit = interchange::fit_shape(volume, some, [&] {
        expect_to_go_on();
        progress_.update(0, "comparing splats with images of the middle frame");
    });
    exported_.fit->psnr = interchange::psnr_of(interchange::splats_of(volume, exported_.fit->shape), views);
}

void Exporter::expect_room(size_t splats, uint32_t degree) const {
    const uint64_t bytes = uint64_t{splats} * format_.bytes_of_splat(degree) * frame_count();
    fmt::print(stderr, "export: {} frames of about {} splats take about {}\n", frame_count(), splats, size_text(bytes));
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::absolute(options_.output).parent_path();
    const std::filesystem::space_info space = std::filesystem::space(folder, error);
    if (!error && space.available < bytes)
        throw InputError("--output", folder.string(), fmt::format("has {} left", size_text(space.available)),
                         "choose fewer --frames or --most-splats, or another folder");
}

void Exporter::write(const std::filesystem::path& file, std::span<const interchange::Splats> frames) {
    format_.write(file, frames, double{scene_.index.fps});
    exported_.files++;
    exported_.bytes += std::filesystem::file_size(file);
    for (const interchange::Splats& splats : frames) exported_.splats += splats.splats.size();
}

Exported Exporter::run() {
    catch_stop_signals();
    progress_.set_total(frame_count());
    fit_middle_frame();
    std::vector<interchange::Splats> kept;  // for one file
    for (uint32_t frame = first_; frame <= last_; frame++) {
        expect_to_go_on();
        const std::filesystem::path file = numbered_ ? numbered_->file(uint64_t{frame}) : options_.output;
        if (!options_.resume || !std::filesystem::exists(file)) {
            const interchange::SplatShape shape = exported_.fit ? exported_.fit->shape : interchange::SplatShape{};
            kept.push_back(interchange::splats_of(volume_of(frame), shape, format_.rotation));
            if (numbered_ || frame_count() == 1) {
                write(file, kept);
                kept.clear();
            }
        }
        progress_.update(frame - first_ + 1);
    }
    if (!kept.empty()) write(options_.output, kept);
    progress_.finish();
    return exported_;
}

void run(const ExportOptions& options, const CommonOptions& common) {
    format_of(options.output);
    const PublishedScene scene = read_published_scene(options.scene, options.performer, options.up);
    const Exported exported = Exporter(options, scene, common).run();
    if (options.json) {
        nlohmann::ordered_json json = {{"output", options.output},
                                       {"files", exported.files},
                                       {"bytes", exported.bytes},
                                       {"splats", exported.splats}};
        if (exported.fit) {
            json["psnr_db"] = exported.fit->psnr;
            json["width"] = exported.fit->shape.width;
            json["density"] = exported.fit->shape.density;
        }
        fmt::print("{}", json_text(json));
        return;
    }
    fmt::print("{}: {} in {} files, {} splats", options.output, size_text(exported.bytes), exported.files,
               exported.splats);
    if (exported.fit) fmt::print("; images of the middle frame have {:.1f} dB", exported.fit->psnr);
    fmt::print("\n");
}

}  // namespace

void add_export(Command app, CommonOptions& common) {
    Command verb = app.add_verb("export", "Write frames of a clip as Gaussian splats, for other programs");
    const auto options = std::make_shared<ExportOptions>();
    verb.add_option("scene", options->scene,
                    "The .nvv, in segments or not, the .nvs, the .npz of a PlenOctree, or a stage, .gltf or .glb")
        .required();
    verb.add_option("--performer", options->performer,
                    "Of a stage: which, by its name or index; may be left out where there is one");
    verb.add_option("-o,--output", options->output,
                    "out_%04d.ply, .glb or .usda for a file each frame; a .glb or .usda may hold them all")
        .required();
    verb.add_option("--frames", options->frames, "FIRST:LAST of the clip (all)");
    verb.add_option("--most-splats", options->most_splats, "Of each frame: what agrees best is merged (no limit)");
    verb.add_option("--views", options->views, "Images of the middle frame by which the loss is measured")
        .in_range(2, 100)
        .show_default();
    verb.add_option("--size", options->size, "WIDTHxHEIGHT of them; splats look best at about this size")
        .show_default();
    add_up_option(verb, options->up);
    verb.add_flag("--resume", options->resume,
                  "Keep the numbered files that are there; give the same other options as before");
    verb.add_flag("--json", options->json, "Print JSON: files, bytes, splats, psnr_db, width, density");
    verb.footer(
        {"Each leaf becomes a splat of its size, and all of them get the width and the density for which images of the "
         "middle\nframe are most like the clip's. Colours are sRGB with spherical harmonics of the clip's degree.\n"
         ".ply is that of 3D Gaussian Splatting, with +Y down, which viewers turn up by half a turn about z. .glb is "
         "glTF with\nKHR_gaussian_splatting; where it holds several frames, an animation shows one after the other. "
         ".usda is OpenUSD's\nParticleField3DGaussianSplat (26.03 and later) with time samples.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv export build/performer.nvv -o build/splats/frame_%04d.ply --frames 0:4\n"
         "  neuvv export build/performer.nvv -o build/performer.glb --frames 0:4 --most-splats 20000\n"
         "  neuvv export build/performer.nvv -o build/performer.usda --frames 0 --most-splats 20000"});
    verb.callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::tools
