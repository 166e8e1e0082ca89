// neuvv-bench walk: what each part of the walk through the tree saves, as a table of traces that lack some of them.
#include <fmt/format.h>

#include <bit>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "gpu/host_copies.h"
#include "render/volume/performer.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "voctree/files/clip.h"

#include "spirv/other_walks.comp.h"

namespace neuvv::bench {

namespace {

// What a walk does without; the defaults are the renderer's walk.
struct Walk {
    bool restart = false;    // true: reads the node again at every step
    bool from_root = false;  // true: descends from the root, not from the grid
    bool coalesce = true;    // false: steps over each empty cell by itself
};

struct Step {
    std::string name;
    const char* key;  // in JSON
    Walk walk;
    bool ranges = false;  // whether only tiles that may see a leaf are traced, between their bounds
    std::vector<double> ms = {};
};

std::vector<Step> steps() {
    return {{"from the root to every cell", "restart", {true, true, false}},
            {"a node's masks in registers, from the root to every node", "node", {false, true, false}},
            {"tiles that see anything, between their bounds", "ranges", {false, true, false}, true},
            {"empty octants and nodes in one step", "coalesce", {false, true, true}, true},
            {"from a grid over the upper levels", "grid", {false, false, true}, true}};
}

// Lists every tile, without bounds for its rays.
void list_every_tile(const gpu::Device& device, const render::TileRanges& ranges, uint32_t tiles) {
    const uint32_t near = 0, far = ~std::bit_cast<uint32_t>(1e30f);
    const std::vector<glm::uvec2> words(tiles, glm::uvec2(near, far));
    std::vector<uint32_t> list(tiles);
    for (uint32_t tile = 0; tile < tiles; ++tile) list[tile] = tile;
    const uint32_t across = std::min(tiles, kListRow);
    list.resize(ranges.list.bytes / 4, kNoTile);
    const LiveCount count{across, (tiles + across - 1) / across, 1, tiles, 0};
    gpu::upload(device, ranges.ranges, words.data(), words.size() * sizeof(glm::uvec2));
    gpu::upload(device, ranges.list, list.data(), list.size() * 4);
    gpu::upload(device, ranges.count, &count, sizeof(count));
}

// render::TreeTracer with another walk, for one field whose colours are shaded.
struct WalkTracer {
    WalkTracer(const gpu::Device& device, const render::Field& field, const render::SliceTrees& trees,
               const gpu::Buffer& shaded, const render::RayTarget& target, const Walk& walk)
        : pass(device, "walk", device.buffers().fitting(other_walks_comp, other_walks_comp_storage),
               {field.hh_degree, field.node_levels, field.top_levels, 1, kOutputLayer, 0,
                field.has_srgb_colours ? 1u : 0u, walk.restart ? 1u : 0u, walk.from_root ? 1u : 0u,
                walk.coalesce ? 1u : 0u}),
          set(pass, gpu::joined({{kTraceNodes, &trees.nodes}, {kTraceEntries, &shaded}},
                                render::instance_bindings(field, target, render::RayOutput::kLayer, nullptr))) {}
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// A shaded slice of the field, and what each walk needs to trace it.
class WalkBench {
  public:
    WalkBench(const gpu::Device& device, const voctree::VOctree& tree, media::ImageSize size)
        : device_(device),
          field_(render::upload_field(device, tree, render::WeightPrecision::kHalf)),
          layout_{size.width, size.height},
          live_(device, field_, field_.leaf_count),
          trees_(device, field_, render::max_entries(field_), 1),
          shaded_(render::shaded_entries(device, trees_.capacity)),
          target_(device, 2, layout_.ray_tiles(), layout_.image_tiles()),
          slicer_(device, field_, live_, trees_),
          shader_(device, field_, trees_, shaded_),
          ranger_(device, field_, &trees_, target_.ranges) {
        const std::vector<Tile> tiles = render::tiles_of_image(0, size.width, size.height);
        std::copy(tiles.begin(), tiles.end(), target_.rays.tiles.as<Tile>());
        for (const Step& step : steps())
            tracers_.push_back(std::make_unique<WalkTracer>(device, field_, trees_, shaded_, target_, step.walk));
    }

    // Adds the GPU milliseconds of the trace of each step for one view.
    void measure(const tools::ViewStep& view, uint32_t repeats, std::vector<Step>& all) {
        const ShaderCamera camera = render::shader_camera(view.camera);
        for (uint32_t i = 0; i < 2; ++i) target_.set_camera(i, camera, render::range_view(camera));
        gpu::run_once(device_, "slice", [&](gpu::Commands& commands) {
            render::record_cameras(commands, target_);
            render::record_slice_tree(commands, slicer_, 0, static_cast<float>(view.frame));
            render::record_shade(commands, shader_, 0, 0, glm::vec3(camera.origin));
        });
        for (size_t i = 0; i < all.size() && !stop_requested(); ++i) {
            if (!all[i].ranges) list_every_tile(device_, target_.ranges, layout_.ray_tiles());
            for (uint32_t repeat = 0; repeat <= repeats; ++repeat) {
                const double ms = trace(*tracers_[i], all[i].ranges);
                if (repeat > 0) all[i].ms.push_back(ms);  // the first one fills caches
            }
        }
    }

    uint64_t rays() const { return uint64_t{layout_.width} * layout_.height; }

  private:
    double trace(const WalkTracer& tracer, bool ranged) {
        const auto finest = static_cast<uint32_t>(field_.level_begin.size()) - 2;
        commands_.begin();
        render::record_clear(commands_, target_.rays, layout_.ray_tiles());
        render::record_clear_coverage(commands_, target_.ranges);
        if (ranged) render::record_tile_ranges(commands_, ranger_, 0, 1, finest, layout_);
        record_walk(tracer);
        commands_.submit();
        commands_.wait();
        double sum = 0;
        for (const gpu::PassTime& pass : commands_.pass_times())
            if (pass.name == "trace" || pass.name == "tile ranges") sum += pass.milliseconds;
        return sum;
    }

    void record_walk(const WalkTracer& tracer) {
        const gpu::PassScope scope(commands_, "trace");
        gpu::dispatch_indirect(commands_, tracer.pass, tracer.set, target_.ranges.count, 0,
                               render::tree_push(field_, trees_, 0, {.first_camera = 1}));
        gpu::compute_barrier(commands_);
    }

    const gpu::Device& device_;
    const render::Field field_;
    const render::ViewLayout layout_;
    const render::LiveLeaves live_;
    const render::SliceTrees trees_;
    const gpu::Buffer shaded_;
    render::RayTarget target_;
    const render::TreeSlicer slicer_;
    const render::Shader shader_;
    const render::TileRanger ranger_;
    std::vector<std::unique_ptr<WalkTracer>> tracers_;
    gpu::Commands commands_{device_, "walk"};
};

void print(const std::vector<Step>& all, uint64_t rays, const gpu::Device& device, const BenchOptions& options) {
    fmt::print("{}: {}, {}, {} views; a shaded slice, each step with those before it\n", device.summary().name,
               options.scene, options.size, options.views);
    fmt::print("{:<58} {:>9} {:>8} {:>10} {:>10}\n", "", "ms (p50)", "ns a ray", "of before", "of first");
    for (size_t i = 0; i < all.size(); ++i) {
        const double ms = median(all[i].ms);
        fmt::print("{:<58} {:>9} {:>8.3g} {:>10.2f} {:>10.2f}\n", all[i].name, ms_text(ms),
                   1e6 * ms / static_cast<double>(rays), ms / median(all[i > 0 ? i - 1 : 0].ms),
                   ms / median(all[0].ms));
    }
}

nlohmann::ordered_json json_of(const std::vector<Step>& all, uint64_t rays) {
    auto walk = nlohmann::ordered_json::object();
    for (const Step& step : all) walk[step.key] = median(step.ms);
    return {{"rays", rays}, {"trace_ms", walk}};
}

void run_walk(const BenchOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::VOctree tree = voctree::read_clip(options.scene, voctree::PlenoctreeColours::kAsStored);
    const gpu::Device device(common.device);
    const media::ImageSize size = tools::parse_size(options.size);
    const std::vector<tools::ViewStep> orbit = tools::orbit_path(tree, size);
    WalkBench bench(device, tree, size);
    std::vector<Step> all = steps();
    tools::Progress progress("bench", options.views);
    for (uint32_t i = 0; i < options.views && !stop_requested(); ++i) {
        bench.measure(orbit[i * orbit.size() / options.views], options.repeats, all);
        progress.update(i + 1);
    }
    expect_not_stopped();
    report(options, device, json_of(all, bench.rays()), [&] { print(all, bench.rays(), device, options); });
}

}  // namespace

void add_walk(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(
        app, common,
        {"walk",
         "What each part of the walk through the tree is worth",
         "Traces the same shaded slice by walks that do without what the renderer's does, and prints GPU time.\n",
         {"work/performer.nvv"}},
        run_walk);
    add_size_option(verb, options);
    add_views_option(verb, options);
    add_repeats_option(verb, options, "Traces of each view that the medians are over");
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench
