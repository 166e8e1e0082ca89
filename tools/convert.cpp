// neuvv convert: writes a scene as a smaller file, its weights rounded as coarsely as the quality of its images allows.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "tools/commands.h"
#include "tools/compared_views.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "tools/unfinished_clip.h"
#include "training/rig/rig_file.h"
#include "voctree/coarse.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvv.h"
#include "voctree/files/world_frame.h"
#include "voctree/frames.h"
#include "voctree/kinds/clip_source.h"
#include "voctree/round.h"

namespace neuvv::tools {

namespace {

struct ConvertOptions {
    std::string scene, output, size = "480x270";
    double quality = 48;
    uint32_t views = 6;
    int compression = 9;
    bool json = false;
    std::optional<voctree::UpAxis> up;
};

// The error that rounding may make in a leaf grows with its strength: four more double it.
constexpr int kStrengths = 48;
float error_of(int strength) {
    return std::exp2(static_cast<float>(strength - kStrengths) / 4);
}

voctree::VOctree rounded(const voctree::VOctree& tree, int strength) {
    voctree::VOctree result = tree;
    voctree::round_weights(result, error_of(strength));
    voctree::drop_empty_leaves(result);
    return result;
}

// How strongly the weights are rounded, and the lowest PSNR in dB that an image then has.
struct Rounding {
    int strength = 0;
    double psnr = 0;
};

// Searches by bisection for the greatest strength whose images keep the quality. Throws InputError where none does.
Rounding find_rounding(const std::filesystem::path& file, const voctree::VOctree& tree, const ComparedViews& views,
                       const ConvertOptions& options) {
    const std::vector<media::Image> truth = views.render(tree);
    Progress progress("convert", std::bit_width(static_cast<unsigned>(kStrengths)));
    Rounding best, last;
    uint64_t done = 0;
    for (int low = 0, high = kStrengths;
         low < high;) {  // strengths below `low` keep the quality, those from `high` on do not
        if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", options.output));
        last.strength = (low + high) / 2;
        last.psnr = worst_psnr(truth, views.render(rounded(tree, last.strength)));
        const bool keeps = last.psnr >= options.quality;
        if (keeps) best = last;
        (keeps ? low : high) = keeps ? last.strength + 1 : last.strength;
        progress.update(++done, fmt::format("error {:.4f}: {:.1f} dB", error_of(last.strength), last.psnr));
    }
    if (best.psnr == 0)
        throw InputError(file.string(), "",
                         fmt::format("the finest steps show {:.1f} dB, not {:.1f}", last.psnr, options.quality),
                         fmt::format("ask for --quality {:.0f}", std::floor(last.psnr)));
    return best;
}

struct Outcome {
    double psnr = 99;  // of the worst image
    float error = 0;   // the largest that rounding may make
    uint32_t leaves_before = 0, leaves = 0;
    uint64_t bytes_before = 0, bytes = 0, images = 0;
};

// Writes `file` smaller, and adds what came of it.
void convert_file(const gpu::Device& device, const voctree::ClipSegment& file, const std::filesystem::path& output,
                  const ConvertOptions& options, Outcome& outcome) {
    const voctree::VOctree tree = voctree::read_segment(file);
    const uint64_t bytes_before = std::filesystem::file_size(file.file);
    voctree::VOctree result = tree;
    if (tree.leaf_count > 0) {  // else the performer is not in this segment
        const Rounding rounding = find_rounding(
            file.file, tree, ComparedViews(device, tree, parse_size(options.size), options.views), options);
        result = rounded(tree, rounding.strength);
        outcome.psnr = std::min(outcome.psnr, rounding.psnr);
        outcome.error = std::max(outcome.error, error_of(rounding.strength));
        outcome.images += options.views;
    }
    const voctree::ChunkOfFrame chunk(voctree::read_world_frame(file.file));
    voctree::write_nvv(output, result, chunk.views(), options.compression, voctree::coarse_tree(result));
    outcome.leaves_before += tree.leaf_count;
    outcome.leaves += result.leaf_count;
    outcome.bytes_before += bytes_before;
    outcome.bytes += std::filesystem::file_size(output);
}

// Each segment keeps the quality by itself.
Outcome convert_segments(const gpu::Device& device, const ConvertOptions& options) {
    const voctree::ClipIndex index = voctree::read_clip_index(options.scene);
    for (const voctree::ClipSegment& segment : index.segments) segment.source->header(segment);
    const UnfinishedClip clip(options.output);
    voctree::ClipIndex smaller = index;
    Outcome outcome;
    for (size_t i = 0; i < index.segments.size(); ++i) {
        say("segment {} of {}\n", i + 1, index.segments.size());
        smaller.segments[i].file = clip.folder() / voctree::segment_file_name(index.segments[i].first);
        convert_file(device, index.segments[i], smaller.segments[i].file, options, outcome);
    }
    if (const auto correction = training::read_rig_correction(options.scene))  // a part may be trained again
        training::write_rig_correction(clip.folder(), *correction);
    voctree::write_clip_index(clip.folder(), smaller);
    clip.finish(clip.folder());
    return outcome;
}

Outcome convert(const ConvertOptions& options, const CommonOptions& common) {
    voctree::expect_no_stream(options.scene);
    const bool segmented = voctree::is_segmented(options.scene);
    if (!segmented) prepare_result("--output", options.output, {".nvv"});
    const gpu::Device device(common.device);
    catch_stop_signals();
    if (segmented) return convert_segments(device, options);
    Outcome outcome;
    const voctree::ClipIndex index = voctree::read_clip_index(options.scene, up_of(options.scene, options.up));
    convert_file(device, index.segments[0], options.output, options, outcome);
    return outcome;
}

void run(const ConvertOptions& options, const CommonOptions& common) {
    const Outcome outcome = convert(options, common);
    if (options.json)
        tell("{}", json_text({{"input", options.scene},
                              {"output", options.output},
                              {"quality_db", options.quality},
                              {"psnr_db", outcome.psnr},
                              {"error", outcome.error},
                              {"bytes_before", outcome.bytes_before},
                              {"bytes", outcome.bytes},
                              {"leaves_before", outcome.leaves_before},
                              {"leaves", outcome.leaves}}));
    else
        tell("{}: {} instead of {} ({:.0f} %), {} leaves instead of {}; the worst of {} images has {:.1f} dB\n",
             options.output, size_text(outcome.bytes), size_text(outcome.bytes_before),
             100 * static_cast<double>(outcome.bytes) / static_cast<double>(outcome.bytes_before), outcome.leaves,
             outcome.leaves_before, outcome.images, outcome.psnr);
    if (outcome.bytes >= outcome.bytes_before)
        say("{} was packed as well already: a lower --quality makes it smaller\n", options.scene);
}

}  // namespace

void add_convert(Command app, CommonOptions& common) {
    Command verb = app.add_verb("convert", "Write a scene smaller, its images as good as asked for");
    const auto options = std::make_shared<ConvertOptions>();
    verb.add_option("scene", options->scene, "The .nvv, in segments or not, or the .npz of a PlenOctree").required();
    verb.add_option("-o,--output", options->output, "The .nvv to write").required();
    add_up_option(verb, options->up);
    verb.add_option("--quality", options->quality,
                    "PSNR in dB that each image keeps at least, against the scene's own image")
        .number_between(10, 90)
        .show_default();
    verb.add_option("--views", options->views, "Images that are compared, over one orbit as the clip plays")
        .in_range(1, 100)
        .show_default();
    verb.add_option("--size", options->size, "WIDTHxHEIGHT of them").show_default();
    verb.add_option("--compression", options->compression,
                    "zstd's level: 19 takes a tenth to a sixth off, and ten times as long as 9 to write")
        .in_range(1, 19)
        .show_default();
    verb.add_flag("--json", options->json, "Print JSON: psnr_db, bytes_before, bytes, leaves, ...");
    verb.footer(
        {"Rounds weights in coarser steps, more where leaves show little: the coarsest that keep "
         "the quality, by bisection.\nPSNR is over whole images on white, as `neuvv eval` takes "
         "it. What else the file carries (chunks that only some\nprograms know) is left out.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv convert work/performer.nvv -o work/small.nvv\n"
         "  neuvv convert work/performer.nvv -o work/smaller.nvv --quality 38 --compression 19"});
    verb.callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::tools
