// neuvv-bench open: the time from a scene's path to the image of its coarse tree, and to that of the whole tree.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "base/output_path.h"
#include "base/threads/parallel.h"
#include "media/psnr.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/view_path.h"
#include "voctree/coarse.h"
#include "voctree/files/clip.h"
#include "voctree/files/half.h"
#include "voctree/files/nvv.h"
#include "voctree/temporal_basis.h"

namespace neuvv::bench {

namespace {

struct OpenOptions : BenchOptions {
    std::string images;
    double synthetic_megabytes = 0;
};

// What happens between a path and an image, in seconds.
struct Opening {
    uint32_t leaves = 0;
    double read = 0, check = 0, upload = 0, prepare = 0, render = 0;  // `check` is a part of `read`, measured once more
    media::Image image;
    double total() const { return read + upload + prepare + render; }
};

double seconds_since(std::chrono::steady_clock::time_point& mark) {
    const auto before = std::exchange(mark, std::chrono::steady_clock::now());
    return std::chrono::duration<double>(mark - before).count();
}

// `view`: of both images, set with the first tree; the time that this takes is not counted.
Opening open(const gpu::Device& device, const std::function<voctree::VOctree()>& read,
             std::optional<tools::ViewStep>& view, media::ImageSize size) {
    Opening result;
    auto mark = std::chrono::steady_clock::now();
    const voctree::VOctree tree = read();
    result.read = seconds_since(mark);
    if (!voctree::defect_of(tree).empty()) throw std::logic_error("a tree that was read has no defect");
    result.check = seconds_since(mark);
    result.leaves = tree.leaf_count;
    if (!view) view = tools::orbit_path(tree, size)[0];

    seconds_since(mark);
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    result.upload = seconds_since(mark);
    render::FrameRenderer renderer(device, field, {size.width, size.height});
    result.prepare = seconds_since(mark);
    render::FrameSettings settings = play_settings(size);
    settings.instances[0].frame = static_cast<float>(view->frame);
    result.image = renderer.render(view->camera, settings);
    result.render = seconds_since(mark);
    return result;
}

nlohmann::ordered_json json_of(const Opening& opening) {
    return {{"leaves", opening.leaves},  {"total_s", opening.total()}, {"read_s", opening.read},
            {"check_s", opening.check},  {"upload_s", opening.upload}, {"prepare_s", opening.prepare},
            {"render_s", opening.render}};
}

void print(const char* name, const Opening& opening) {
    fmt::print("{:<12} {:>9} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f}\n", name, opening.leaves,
               opening.total(), opening.read, opening.check, opening.upload, opening.prepare, opening.render);
}

// Both openings; `first` is missing where the file has no coarse tree.
struct OpenResult {
    uint64_t file_bytes = 0;
    std::optional<Opening> first;
    Opening whole;
    double share() const { return first ? first->total() / whole.total() : 1; }
    double psnr() const { return first ? media::psnr_db(whole.image, first->image) : 99; }
};

nlohmann::ordered_json json_of(const OpenResult& result) {
    return {{"bytes", result.file_bytes},
            {"first", result.first ? json_of(*result.first) : nlohmann::ordered_json()},
            {"whole", json_of(result.whole)},
            {"share", result.share()},
            {"psnr_db", result.psnr()}};
}

void print(const OpenResult& result, const gpu::Device& device, const OpenOptions& options) {
    fmt::print("{}: {}, {}, images of {}\n", device.summary().name, options.scene, tools::size_text(result.file_bytes),
               options.size);
    fmt::print("{:<12} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "seconds", "leaves", "total", "read", "checks",
               "upload", "prepare", "render");
    if (result.first) print("coarse tree", *result.first);
    print("whole tree", result.whole);
    if (result.first)
        fmt::print("the first image takes {:.1f} % of the time of the whole, and has {:.1f} dB against it\n",
                   100 * result.share(), result.psnr());
    else
        fmt::print("the file has no coarse tree: fewer than {} leaves, or not written as such\n",
                   voctree::kMinLeavesForCoarse);
}

constexpr double kBytesPerLeaf = 282;  // in the compressed file
constexpr double kThickness = 8;       // of the ball's shell, in leaves
constexpr uint32_t kSyntheticFrames = kMaxBases;

// Random bits, the same for the same leaf and weight (the mixing function of splitmix64).
uint64_t noise(uint64_t leaf, uint64_t weight) {
    uint64_t x = leaf * 256 + weight + 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

// A finite half with random sign, exponent and digits.
float any_half(uint64_t bits) {
    const uint64_t exponent = (bits >> 16) % 31;
    return voctree::float_from_half(static_cast<uint16_t>((bits & 0x83ff) | exponent << 10));
}

// The cells between two spheres, in a cube of 2^depth cells a side; `radius` in cells.
std::vector<voctree::LeafPosition> shell(uint32_t depth, double radius) {
    std::vector<voctree::LeafPosition> positions;
    const double centre = std::ldexp(0.5, static_cast<int>(depth));
    const uint32_t side = 1u << depth;
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y) {
            const double dy = y + 0.5 - centre, dz = z + 0.5 - centre, across = dy * dy + dz * dz;
            const double outer = (radius + kThickness / 2) * (radius + kThickness / 2) - across;
            if (outer < 0) continue;
            const double inner = (radius - kThickness / 2) * (radius - kThickness / 2) - across;
            const auto first_x = static_cast<uint32_t>(centre - 0.5 - std::sqrt(outer)) + 1;
            for (uint32_t x = first_x; x < side - first_x; ++x) {
                const double dx = x + 0.5 - centre;
                if (dx * dx >= inner) positions.push_back({x, y, z, depth});
            }
        }
    return positions;
}

// A striped ball of 64 frames whose numbers differ from leaf to leaf so that they hardly pack: its .nvv has about
// `megabytes` MB. It has as few leaves as that allows, because devices bound the texels of a buffer.
voctree::VOctree synthetic_scene(double megabytes) {
    const double leaves = 1e6 * megabytes / kBytesPerLeaf;
    const double radius = std::sqrt(leaves / (4 * std::numbers::pi * kThickness));  // in leaves
    const auto depth = static_cast<uint32_t>(std::ceil(std::log2(std::max(radius, 4.0) / 0.48)));
    voctree::VOctree tree;
    tree.node_levels = (depth + 1) / 2;
    tree.box_min = glm::vec3(-1);
    tree.box_size = glm::vec3(2);
    tree.bases = tree.frames = kSyntheticFrames;
    tree.hh_degree = 1;
    tree.sigma_basis = voctree::hat_basis(kSyntheticFrames, kSyntheticFrames);
    tree.gamma_basis = tree.sigma_basis;
    std::vector<voctree::LeafPosition> positions = shell(depth, radius);
    const auto before = [&](const voctree::LeafPosition& a, const voctree::LeafPosition& b) {
        return voctree::first_cell(a, depth) < voctree::first_cell(b, depth);
    };
    std::sort(positions.begin(), positions.end(), before);
    voctree::build_topology(tree, positions);
    parallel_for(positions.size(), 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            float* leaf = tree.leaf(static_cast<uint32_t>(i));
            for (uint32_t w = 0; w < 2 * kSyntheticFrames; ++w) leaf[w] = any_half(noise(i, w));
            for (uint32_t w = 2 * kSyntheticFrames; w < tree.weights_per_leaf(); ++w)
                leaf[w] = static_cast<float>(static_cast<int64_t>(noise(i, w))) * 0x1p-64f;
            const uint32_t band = positions[i].y * 16 >> depth, side = positions[i].x * 16 >> depth;
            for (uint32_t channel = 0; channel < 3; ++channel)
                leaf[2 * kSyntheticFrames + channel * hh_count(1)] += ((band + side * channel) & 1) ? 8.0f : -8.0f;
        }
    });
    return tree;
}

void write_synthetic(const OpenOptions& options) {
    if (std::filesystem::exists(options.scene))
        throw InputError(options.scene, "", "is there already", "name a new file, or leave --synthetic out");
    prepare_output_file("scene", options.scene);
    const voctree::VOctree tree = synthetic_scene(options.synthetic_megabytes);
    voctree::write_nvv(options.scene, tree, {}, 1, voctree::coarse_tree(tree));
}

bool has_coarse_tree(const std::string& scene) {
    if (voctree::kind_of(scene) != voctree::ClipKind::kNvv) return false;
    const voctree::NvvSummary summary = voctree::summarise_nvv(scene);
    return summary.chunks.size() > 1 && summary.chunks[1].name == "hEAD";
}

void run_open(const OpenOptions& options, const tools::CommonOptions& common) {
    const media::ImageSize size = tools::parse_size(options.size);
    if (!options.images.empty()) tools::prepare_results("--images", options.images, {"coarse.png", "whole.png"});
    if (options.synthetic_megabytes > 0) write_synthetic(options);
    const bool has_coarse = has_coarse_tree(options.scene);
    const gpu::Device device(common.device);
    std::optional<tools::ViewStep> view;
    OpenResult result;
    if (has_coarse)
        result.first = open(
            device, [&] { return *voctree::read_nvv_coarse(options.scene); }, view, size);
    result.whole = open(
        device, [&] { return voctree::read_clip(options.scene, voctree::PlenoctreeColours::kAsStored); }, view, size);
    if (!options.images.empty()) {
        if (result.first) media::write_png(std::filesystem::path(options.images) / "coarse.png", result.first->image);
        media::write_png(std::filesystem::path(options.images) / "whole.png", result.whole.image);
    }
    result.file_bytes = std::filesystem::file_size(options.scene);
    report(options, device, json_of(result), [&] { print(result, device, options); });
}

}  // namespace

void add_open(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] =
        add_verb(app, common,
                 {"open",
                  "From a scene's path to its first image, and to the whole",
                  "Times one opening each of the coarse tree, which stands first in the file, and of the whole: read "
                  "(unpacked and checked;\nhow long the checks of the tree take of it is measured once more, apart), "
                  "upload, prepare (the renderer and its\npipelines), render (the first image, its slice "
                  "included). Finding the device is not counted. The system's cache\nof files is used as it is, and "
                  "the coarse opening, which is first, also compiles the pipelines. ",
                  {"work/performer.nvv", "work/large.nvv --synthetic 1000"}},
                 run_open);
    verb.add_option("--synthetic", options.synthetic_megabytes,
                    "First write a made-up scene of about so many MB there; it stays. 1000 MB are about what devices "
                    "hold in one "
                    "buffer")
        .number_between(1, 1000);
    add_size_option(verb, options);
    verb.add_option("--images", options.images, "A folder for the two images: coarse.png and whole.png");
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench
