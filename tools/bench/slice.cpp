// neuvv-bench slice: the time of each pass of a frame's slice, and the share of the device's bandwidth that it reaches.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "gpu/host_copies.h"
#include "render/volume/slices/slice_tree.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "voctree/files/clip.h"

namespace neuvv::bench {

namespace {

struct SliceOptions : BenchOptions {
    SliceOptions() { size.clear(), repeats = 3; }
    uint32_t frames = 12;
};

struct SliceTimes {
    std::vector<double> density, nodes, entries, whole, slots;  // ms
    std::vector<double> live, entry_count;
    double copy_gb_s = 0;
};

// The least bytes that the passes can move. The density pass reads w^σ of every leaf and writes its head. The entry
// pass reads slot, cells, head and node of every live leaf, its w^γ and w^HH, and writes its SH and its leaf.
double density_bytes(const render::Field& field) {
    return field.leaf_count * (8.0 * field.busy_planes + 8);
}
double entry_bytes(const render::Field& field, double live) {
    const double read = 4 + 8 + 8 + 16 + 8.0 * (field.busy_planes + hh_count(field.hh_degree));
    return live * (read + 4.0 * kEntryWords * sh_count(field.hh_degree) + 4);
}

SliceTimes measure(const gpu::Device& device, const render::Field& field, const SliceOptions& options) {
    const render::LiveLeaves live(device, field, field.leaf_count);
    const render::SliceTrees trees(device, field, render::max_entries(field), 1);
    const render::TreeSlicer slicer(device, field, live, trees);
    const render::Slice slots(device, field, field.leaf_count);
    const render::Slicer slot_slicer(device, field, slots);
    gpu::Commands commands(device, "slice");
    SliceTimes times;
    tools::Progress progress("bench", options.frames * options.repeats);
    for (uint32_t i = 0; i <= options.frames * options.repeats && !stop_requested(); ++i) {
        const uint32_t step = (i + options.frames - 1) % options.frames;
        const float frame = static_cast<float>(field.frames - 1) * static_cast<float>(step) /
                            static_cast<float>(std::max(options.frames, 2u) - 1);
        commands.begin();
        render::record_slice_tree(commands, slicer, 0, frame);
        render::record_slice(commands, slot_slicer, frame);
        commands.submit();
        commands.wait();
        if (i == 0) continue;  // the first one fills caches
        const std::vector<gpu::PassTime> passes = commands.pass_times();
        times.density.push_back(passes[0].milliseconds);
        times.nodes.push_back(passes[1].milliseconds);
        times.entries.push_back(passes[2].milliseconds);
        times.whole.push_back(passes[0].milliseconds + passes[1].milliseconds + passes[2].milliseconds);
        times.slots.push_back(passes[3].milliseconds);
        LiveCount count;
        gpu::download(device, live.live, &count, sizeof(count));
        times.live.push_back(count.slots);
        gpu::download(device, trees.counts, &count, sizeof(count));
        times.entry_count.push_back(count.slots);
        progress.update(i);
    }
    times.copy_gb_s = 1e-9 * copied_bytes_per_second(device);
    return times;
}

void run_slice(const SliceOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::VOctree tree = voctree::read_clip(options.scene, voctree::PlenoctreeColours::kAsStored);
    const gpu::Device device(common.device);
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    const SliceTimes times = measure(device, field, options);
    expect_not_stopped();
    const double live = median(times.live), copied = times.copy_gb_s;
    const double density_rate = 1e-6 * density_bytes(field) / median(times.density);
    const double entry_rate = 1e-6 * entry_bytes(field, live) / median(times.entries);
    const uint64_t slice_bytes = render::slice_bytes(field, static_cast<uint32_t>(median(times.entry_count)));
    const nlohmann::ordered_json json = {
        {"leaves", field.leaf_count},      {"live_leaves", live},
        {"slice_bytes", slice_bytes},      {"density_ms", median(times.density)},
        {"nodes_ms", median(times.nodes)}, {"entries_ms", median(times.entries)},
        {"slice_ms", median(times.whole)}, {"slice_p99_ms", quantile(times.whole, 0.99)},
        {"slots_ms", median(times.slots)}, {"density_gb_s", density_rate},
        {"entries_gb_s", entry_rate},      {"copy_gb_s", copied}};
    const auto line = [copied](const char* name, const std::vector<double>& ms, double rate) {
        fmt::print("{:<34} {:>9} {:>9} ms", name, ms_text(median(ms)), ms_text(quantile(ms, 0.99)));
        if (rate > 0) fmt::print(" {:>7.1f} GB/s, {:.0f} % of a copy's", rate, 100 * rate / copied);
        fmt::print("\n");
    };
    report(options, device, json, [&] {
        fmt::print("{}: {}, {} leaves, {:.0f} of them live in a frame; a slice is {}\n", device.summary().name,
                   options.scene, field.leaf_count, live, tools::size_text(slice_bytes));
        fmt::print("{:<34} {:>9} {:>9}\n", "", "p50", "p99");
        line("density of every leaf", times.density, density_rate);
        line("nodes", times.nodes, 0);
        line("entries of live leaves", times.entries, entry_rate);
        line("a slice tree", times.whole, 0);
        line("a slice in slots, as training has it", times.slots, 0);
    });
}

}  // namespace

void add_slice(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] =
        add_verb(app, common,
                 {"slice",
                  "A frame's slice, pass by pass",
                  "Prints the GPU time of each pass, and its share of the bandwidth that a copy has. ",
                  {"work/performer.nvv"}},
                 run_slice);
    verb.add_option("--frames", options.frames, "Times, spread over the clip").in_range(1, 10000).show_default();
    add_repeats_option(verb, options, "Slices of each time");
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench
