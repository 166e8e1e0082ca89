// neuvv-bench stream: what a frame of a stream costs from its bytes until it can be drawn, by the straight path, and by
// a tree with weights that is sliced on the device.
#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "render/volume/slices/slice_upload.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "voctree/files/clip.h"
#include "voctree/kinds/clip_source.h"
#include "voctree/tree_slice.h"

namespace neuvv::bench {

namespace {

struct StreamOptions : BenchOptions {
    StreamOptions() { size.clear(); }
    uint32_t frames = 24;
};

// Milliseconds of all cores together.
struct StreamTimes {
    std::vector<double> decode, upload;            // the straight path, with the host's entries,
    std::vector<double> upload_raw;                // and with those of the device
    std::vector<double> tree, upload_tree, slice;  // by weights, after the same decoding
    std::vector<double> leaves, device_bytes;
};

double core_ms_of(const std::function<void()>& work) {
    const std::clock_t begin = std::clock();
    work();
    return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

// Draws nothing: a slice is built once, as its first image would.
void slice_once(const gpu::Device& device, const render::Field& field) {
    const render::LiveLeaves live(device, field, field.leaf_count);
    const render::SliceTrees trees(device, field, render::max_entries(field), 1);
    const render::TreeSlicer slicer(device, field, live, trees);
    gpu::run_once(device, "slice", [&](gpu::Commands& commands) { render::record_slice_tree(commands, slicer, 0, 0); });
}

void measure_frame(const gpu::Device& device, const voctree::ClipSegment& frame, StreamTimes& times) {
    voctree::SegmentContent content;
    times.decode.push_back(core_ms_of(
        [&] { content = frame.source->content(frame, stream::kShFine, voctree::PlenoctreeColours::kAsStored); }));
    const auto& read = std::get<voctree::FrameSlice>(content);
    const uint64_t before = device.buffer_bytes();
    render::Field field;
    const auto upload = [&](render::Dequantiser by) {
        return core_ms_of([&] { field = render::upload_slice(device, *read.slice, read.box_min, read.box_size, by); });
    };
    times.upload_raw.push_back(upload(render::Dequantiser::kDevice));
    field = {};
    times.upload.push_back(upload(render::Dequantiser::kHost));
    times.device_bytes.push_back(static_cast<double>(device.buffer_bytes() - before));
    times.leaves.push_back(static_cast<double>(read.slice->leaves.size()));
    voctree::VOctree tree;
    times.tree.push_back(
        core_ms_of([&] { tree = voctree::tree_of(slice::values_of(*read.slice, read.box_min, read.box_size), 25); }));
    times.upload_tree.push_back(
        core_ms_of([&] { field = render::upload_field(device, tree, render::WeightPrecision::kHalf); }));
    times.slice.push_back(core_ms_of([&] { slice_once(device, field); }));
}

StreamTimes measure(const gpu::Device& device, const voctree::ClipIndex& clip, const StreamOptions& options) {
    keep_freed_memory();
    StreamTimes times;
    const uint32_t frames = std::min(options.frames, clip.frames());
    tools::Progress progress("bench", frames);
    for (uint32_t i = 0; i < frames && !stop_requested(); ++i) {
        measure_frame(device, clip.segments[i], times);
        progress.update(i + 1);
    }
    return times;
}

void run_stream(const StreamOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::ClipIndex clip = voctree::read_clip_index(options.scene);
    if (!clip.plays_by_frame()) throw InputError(options.scene, "", "is no stream", "`neuvv publish` makes one");
    const gpu::Device device(common.device);
    const StreamTimes times = measure(device, clip, options);
    expect_not_stopped();
    const bool by_device = render::usual_dequantiser(device) == render::Dequantiser::kDevice;
    const double decode = median(times.decode), straight = decode + median(by_device ? times.upload_raw : times.upload);
    const double by_tree = decode + median(times.tree) + median(times.upload_tree) + median(times.slice);
    const nlohmann::ordered_json json = {{"leaves", median(times.leaves)},
                                         {"decode_ms", decode},
                                         {"upload_ms", median(times.upload)},
                                         {"upload_raw_ms", median(times.upload_raw)},
                                         {"straight_ms", straight},
                                         {"tree_ms", median(times.tree)},
                                         {"upload_tree_ms", median(times.upload_tree)},
                                         {"slice_ms", median(times.slice)},
                                         {"by_tree_ms", by_tree},
                                         {"device_bytes", median(times.device_bytes)}};
    report(options, device, json, [&] {
        const auto line = [](const char* name, const std::vector<double>& ms) {
            fmt::print("{:<44} {:>9} {:>9}\n", name, ms_text(median(ms)), ms_text(quantile(ms, 0.99)));
        };
        fmt::print("{}: {}, {} frames of {:.0f} leaves; {} of the device for each\n", device.summary().name,
                   options.scene, times.leaves.size(), median(times.leaves),
                   tools::size_text(static_cast<uint64_t>(median(times.device_bytes))));
        fmt::print("{:<44} {:>9} {:>9}  ms of one core\n", "", "p50", "p99");
        line("bytes to slice", times.decode);
        line("slice to device, entries by the host", times.upload);
        line("slice to device, entries by the device", times.upload_raw);
        line("by weights: slice to tree", times.tree);
        line("by weights: tree to device", times.upload_tree);
        line("by weights: slice on the device", times.slice);
        fmt::print("{:<44} {:>9}\n{:<44} {:>9}\n", "bytes to drawable", ms_text(straight), "the same by weights",
                   ms_text(by_tree));
    });
}

}  // namespace

void add_stream(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] =
        add_verb(app, common,
                 {"stream",
                  "A frame of a stream, from its bytes until it can be drawn",
                  "Prints the time of each step in milliseconds of one core, and beside it that of the way by a tree "
                  "with weights, which players do not take.",
                  {"work/performer.nvs"},
                  "The .nvs"},
                 run_stream);
    verb.add_option("--frames", options.frames, "The first frames of the stream").in_range(1, 10000).show_default();
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench
