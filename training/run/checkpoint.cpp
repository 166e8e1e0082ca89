#include "training/run/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "base/trace_file.h"
#include "gpu/host_copies.h"
#include "training/run/schedule.h"
#include "training/tree/compact.h"
#include "voctree/coarse.h"
#include "voctree/files/nvv.h"
#include "voctree/frames.h"

namespace neuvv::training {

namespace {

constexpr uint32_t kMaxSteps = 1u << 31, kMaxTilesPerStep = 65536;

// bfloat16, rounded to nearest; its precision is enough for moments.
uint16_t bfloat_from_float(float value) {
    const uint32_t bits = std::bit_cast<uint32_t>(value);
    return static_cast<uint16_t>((bits + 0x7fff + (bits >> 16 & 1)) >> 16);
}

float float_from_bfloat(uint16_t value) {
    return std::bit_cast<float>(uint32_t{value} << 16);
}

std::vector<float> fetch(const gpu::Device& device, const gpu::Buffer& buffer, size_t count) {
    std::vector<float> values(count);
    gpu::download(device, buffer, values.data(), count * sizeof(float));
    return values;
}

std::vector<uint16_t> fetch_bfloat(const gpu::Device& device, const gpu::Buffer& buffer, size_t count) {
    std::vector<uint16_t> result(count);
    gpu::download_pieces(device, buffer, count * sizeof(float), [&](const void* piece, uint64_t at, uint64_t bytes) {
        const auto* values = static_cast<const float*>(piece);
        uint16_t* to = &result[at / sizeof(float)];
        parallel_for(bytes / sizeof(float), 1 << 20, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) to[i] = bfloat_from_float(values[i]);
        });
    });
    return result;
}

void upload_bfloat(const gpu::Device& device, const gpu::Buffer& buffer, const std::vector<uint16_t>& values) {
    std::vector<float> floats(values.size());
    for (size_t i = 0; i < values.size(); ++i) floats[i] = float_from_bfloat(values[i]);
    gpu::upload(device, buffer, floats.data(), floats.size() * sizeof(float));
}

// The values must live until the chunk is written.
template <typename T>
voctree::NvvChunkView chunk(const char* name, const std::vector<T>& values) {
    return {name, {reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)}};
}

// The chunks of what is learnt of images' exposures and lenses' vignettes: numbers and their two moments.
constexpr std::array<const char*, 3> kExposureChunks{"expo", "exp1", "exp2"}, kVignetteChunks{"vign", "vig1", "vig2"};

void append_learnt(std::vector<voctree::NvvChunkView>& chunks, std::array<const char*, 3> names,
                   const LearntNumbers& numbers) {
    if (numbers.values.empty()) return;
    chunks.push_back(chunk(names[0], numbers.values));
    chunks.push_back(chunk(names[1], numbers.first));
    chunks.push_back(chunk(names[2], numbers.second));
}

const voctree::NvvChunk& find_chunk(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                                    const char* name) {
    for (const voctree::NvvChunk& candidate : chunks)
        if (candidate.name == name) return candidate;
    throw InputError(path.string(), "chunk " + std::string(name), "is missing: this is no state of a training run",
                     Remedy::kTrainAnew);
}

[[noreturn]] void fail_chunk(const std::filesystem::path& path, const char* name, const char* problem) {
    throw InputError(path.string(), "chunk " + std::string(name), problem, Remedy::kTrainAnew);
}

[[noreturn]] void fail_finite(const std::filesystem::path& path, const char* name) {
    fail_chunk(path, name, "holds a number that is not finite");
}

template <typename T>
std::vector<T> read_chunk(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                          const char* name, size_t count) {
    const voctree::NvvChunk& found = find_chunk(path, chunks, name);
    if (found.bytes.size() != count * sizeof(T)) fail_chunk(path, name, "does not fit the tree");
    std::vector<T> values(count);
    std::memcpy(values.data(), found.bytes.data(), found.bytes.size());
    return values;
}

std::vector<float> read_floats(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                               const char* name, size_t count) {
    std::vector<float> values = read_chunk<float>(path, chunks, name, count);
    for (const float value : values)
        if (!std::isfinite(value)) fail_finite(path, name);
    return values;
}

std::vector<uint16_t> read_bfloats(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                                   const char* name, size_t count) {
    std::vector<uint16_t> values = read_chunk<uint16_t>(path, chunks, name, count);
    for (const uint16_t value : values)
        if (!std::isfinite(float_from_bfloat(value))) fail_finite(path, name);
    return values;
}

// The numbers of `cameras` cameras' colours.
std::vector<CameraColour> read_colours(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                                       const char* name, size_t cameras) {
    const std::vector<float> numbers = read_floats(path, chunks, name, 12 * cameras);
    std::vector<CameraColour> colours(cameras);
    std::memcpy(colours.data(), numbers.data(), numbers.size() * sizeof(float));
    return colours;
}

// Numbers with their moments, under three names; none where there is no such chunk.
LearntNumbers read_learnt(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                          std::array<const char*, 3> names, float most) {
    const auto found = std::ranges::find(chunks, std::string(names[0]), &voctree::NvvChunk::name);
    if (found == chunks.end()) return LearntNumbers();
    const size_t count = std::max<size_t>(found->bytes.size() / sizeof(float), 1);
    LearntNumbers numbers;
    numbers.values = read_floats(path, chunks, names[0], count);
    numbers.first = read_floats(path, chunks, names[1], count);
    numbers.second = read_floats(path, chunks, names[2], count);
    for (const float value : numbers.values)
        if (std::abs(value) > most) fail_chunk(path, names[0], "has numbers out of bounds");
    for (const float second : numbers.second)
        if (second < 0) fail_chunk(path, names[2], "has numbers below 0");
    return numbers;
}

// What a run learns of cameras' colours is stored where it refines them.
CameraColours read_all_colours(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                               uint32_t frames) {
    const auto found = std::ranges::find(chunks, std::string("camc"), &voctree::NvvChunk::name);
    if (found == chunks.end()) return {};
    const size_t cameras = std::max<size_t>(found->bytes.size() / sizeof(CameraColour), 1);
    CameraColours colours;
    colours.values = read_colours(path, chunks, "camc", cameras);
    if (!std::ranges::all_of(colours.values, is_bounded)) fail_chunk(path, "camc", "has colours out of bounds");
    const auto is_moment = [](const voctree::NvvChunk& one) { return one.name == "cam1" || one.name == "cam2"; };
    if (std::ranges::any_of(chunks, is_moment)) {
        colours.first = read_colours(path, chunks, "cam1", cameras);
        colours.second = read_colours(path, chunks, "cam2", cameras);
    }
    for (const CameraColour& second : colours.second)
        for (const glm::vec4& row : second.rows)
            if (glm::any(glm::lessThan(row, glm::vec4(0)))) fail_chunk(path, "cam2", "has numbers below 0");
    colours.exposures = read_learnt(path, chunks, kExposureChunks, kMaxExposure);
    colours.vignettes = read_learnt(path, chunks, kVignetteChunks, kMaxVignette);
    if (!colours.exposures.values.empty() && colours.exposures.values.size() != cameras * frames)
        fail_chunk(path, kExposureChunks[0], "does not fit cameras and frames");
    if (!colours.vignettes.values.empty() && colours.vignettes.values.size() != 2 * cameras)
        fail_chunk(path, kVignetteChunks[0], "does not fit the cameras");
    return colours;
}

// Changes of poses are stored where a run refined them.
std::vector<PoseChange> read_poses(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks) {
    const auto found = std::ranges::find(chunks, std::string("pose"), &voctree::NvvChunk::name);
    if (found == chunks.end()) return {};
    const size_t cameras = std::max<size_t>(found->bytes.size() / sizeof(PoseChange), 1);
    const std::vector<PoseChange> poses = read_chunk<PoseChange>(path, chunks, "pose", cameras);
    if (!std::ranges::all_of(poses, is_possible)) fail_chunk(path, "pose", "holds a number that no run can find");
    return poses;
}

// Numbers of frames by camera, none larger than `most`; nothing where the file has no such chunk.
std::vector<double> read_frames(const std::filesystem::path& path, const std::vector<voctree::NvvChunk>& chunks,
                                const char* name, double most) {
    const auto found = std::ranges::find(chunks, std::string(name), &voctree::NvvChunk::name);
    if (found == chunks.end()) return {};
    const std::vector<double> by_camera =
        read_chunk<double>(path, chunks, name, std::max<size_t>(found->bytes.size() / sizeof(double), 1));
    for (const double frames : by_camera)
        if (!(std::abs(frames) <= most)) fail_chunk(path, name, "holds a number that no run can find");
    return by_camera;
}

std::string weight_key(const NamedLossWeight& one) {
    return std::string("lambda_") + one.name;
}

voctree::NvvChunk run_chunk(const RunState& run) {
    nlohmann::json json = {{"seed", run.seed},
                           {"step", run.step},
                           {"adam_step", run.adam_step},
                           {"stage", run.phase},
                           {"stage_rays", run.phase_rays},
                           {"dataset_hash", run.dataset_hash},
                           {"max_depth", run.max_depth},
                           {"several_from", run.several_rays_from},
                           {"max_leaves", run.max_leaves},
                           {"max_bytes", run.max_bytes},
                           {"adaptive", run.adaptive},
                           {"colour_choice", static_cast<uint32_t>(run.colour_choice)},
                           {"leaves_along_image", run.leaves_along_image},
                           {"leaf_pixels", run.leaf_pixels},
                           {"natural", run.resolution_is_natural},
                           {"left_out", run.left_out},
                           {"elapsed_s", run.elapsed_s},
                           {"other_s", run.other_s},
                           {"rays", run.rays},
                           {"squared_error", run.squared_error},
                           {"minutes", run.minutes},
                           {"steps", run.steps},
                           {"tiles_per_step", run.tiles_per_step},
                           {"program", run.program}};
    for (const NamedLossWeight& one : kLossWeights) json[weight_key(one)] = run.weights.*one.weight;
    const std::string text = json.dump();
    return {"run0", std::vector<uint8_t>(text.begin(), text.end())};
}

// Reads a whole number of 0 to `max`. The JSON library's own conversion would not refuse other numbers.
template <typename T>
void read_count(const nlohmann::json& json, const char* key, T& value, uint64_t max = std::numeric_limits<T>::max()) {
    const nlohmann::json& found = json.at(key);
    if (!found.is_number_unsigned() || found.get<uint64_t>() > max) throw std::out_of_range(key);
    value = found.get<T>();
}

// `max_depth`: the deepest level that the tree's nodes can have.
RunState read_run(const std::filesystem::path& path, const voctree::NvvChunk& found, uint32_t max_depth) {
    RunState run;
    try {
        const nlohmann::json json = nlohmann::json::parse(found.bytes.begin(), found.bytes.end());
        read_count(json, "seed", run.seed);
        read_count(json, "step", run.step, kMaxSteps);
        read_count(json, "adam_step", run.adam_step, kMaxSteps);
        read_count(json, "stage", run.phase, kPhaseCount - 1);
        read_count(json, "stage_rays", run.phase_rays);
        read_count(json, "dataset_hash", run.dataset_hash);
        read_count(json, "max_depth", run.max_depth, max_depth);
        read_count(json, "several_from", run.several_rays_from);
        read_count(json, "max_leaves", run.max_leaves);
        read_count(json, "max_bytes", run.max_bytes);
        json.at("adaptive").get_to(run.adaptive);
        uint32_t choice = 0;
        if (json.contains("colour_choice"))
            read_count(json, "colour_choice", choice, static_cast<uint32_t>(ColourChoice::kChosen));
        run.colour_choice = static_cast<ColourChoice>(choice);
        if (json.contains("leaves_along_image")) read_count(json, "leaves_along_image", run.leaves_along_image);
        run.leaf_pixels = json.value("leaf_pixels", 0.0);
        run.resolution_is_natural = json.value("natural", false);
        if (json.contains("left_out")) read_count(json, "left_out", run.left_out, (1u << kOptionalParts.size()) - 1);
        json.at("elapsed_s").get_to(run.elapsed_s);
        json.at("other_s").get_to(run.other_s);
        json.at("rays").get_to(run.rays);
        run.squared_error = json.value("squared_error", 0.0);
        json.at("minutes").get_to(run.minutes);
        read_count(json, "steps", run.steps);
        read_count(json, "tiles_per_step", run.tiles_per_step, kMaxTilesPerStep);
        for (const NamedLossWeight& one : kLossWeights) json.at(weight_key(one)).get_to(run.weights.*one.weight);
        json.at("program").get_to(run.program);
    } catch (const nlohmann::json::exception&) {
        throw InputError(path.string(), "chunk run0", "cannot be read", Remedy::kTrainAnew);
    } catch (const std::out_of_range& key) {
        throw InputError(path.string(), "chunk run0", fmt::format("holds a number out of range: \"{}\"", key.what()),
                         Remedy::kTrainAnew);
    }
    std::vector<double> amounts{run.elapsed_s,     run.other_s,    run.elapsed_s - run.other_s, run.rays, run.minutes,
                                run.squared_error, run.leaf_pixels};
    for (const NamedLossWeight& one : kLossWeights) amounts.push_back(double{run.weights.*one.weight});
    for (const double amount : amounts)
        if (!(amount >= 0) || !std::isfinite(amount))
            throw InputError(path.string(), "chunk run0", "holds a number out of range", Remedy::kTrainAnew);
    if (run.max_depth < 1 || run.tiles_per_step < 1)
        throw InputError(path.string(), "chunk run0", "holds a 0 where none can be", Remedy::kTrainAnew);
    return run;
}

size_t plane_numbers(const voctree::VOctree& tree) {
    return size_t{4} * tree.leaf_count * (2 * ((tree.bases + 3) / 4) + hh_count(tree.hh_degree));
}

}  // namespace

std::filesystem::path state_path(const std::filesystem::path& nvv) {
    return nvv.string() + ".state";
}

Checkpoint take_checkpoint(const TrainingStep& step, const voctree::VOctree& tree, const RunState& run,
                           const CameraColours& colours, const RigChanges& rig) {
    const TraceSpan span("read the device's state");
    Checkpoint checkpoint{run, tree, {}, {}, {}, {}, {}, colours, rig};
    step.download(checkpoint.tree);
    const gpu::Device& device = *step.field().whole_weights().device;
    checkpoint.use = read_use(device, step.tally(), tree);
    const Moments& moments = step.moments();
    const size_t rows = size_t{2} * tree.frames * tree.bases;
    checkpoint.first = fetch_bfloat(device, moments.first, plane_numbers(tree));
    checkpoint.second = fetch_bfloat(device, moments.second, plane_numbers(tree));
    checkpoint.rows_first = fetch(device, moments.rows_first, rows);
    checkpoint.rows_second = fetch(device, moments.rows_second, rows);
    return checkpoint;
}

uint32_t save_checkpoint(const std::filesystem::path& nvv, Checkpoint checkpoint) {
    const std::string defect = voctree::defect_of(checkpoint.tree);
    if (!defect.empty()) throw RuntimeFailure(fmt::format("{}: not written: {}", state_path(nvv).string(), defect));
    // Chunk wf32 has the weights as they are. The chunks of a .nvv, which rounds them, get zeros, which take no space.
    std::vector<float> weights(checkpoint.tree.weights.size());
    weights.swap(checkpoint.tree.weights);
    const voctree::NvvChunk run = run_chunk(checkpoint.run);
    std::vector<voctree::NvvChunkView> chunks{voctree::NvvChunkView(run),
                                              chunk("wf32", weights),
                                              chunk("mom1", checkpoint.first),
                                              chunk("mom2", checkpoint.second),
                                              chunk("row1", checkpoint.rows_first),
                                              chunk("row2", checkpoint.rows_second),
                                              chunk("rech", checkpoint.use.max_weight),
                                              chunk("pull", checkpoint.use.opacity_sensitivity),
                                              chunk("frms", checkpoint.use.frames)};
    const CameraColours& colours = checkpoint.colours;
    if (!colours.empty()) chunks.push_back(chunk("camc", colours.values));
    if (!colours.first.empty()) {
        chunks.push_back(chunk("cam1", colours.first));
        chunks.push_back(chunk("cam2", colours.second));
    }
    append_learnt(chunks, kExposureChunks, colours.exposures);
    append_learnt(chunks, kVignetteChunks, colours.vignettes);
    if (!checkpoint.rig.poses.empty()) chunks.push_back(chunk("pose", checkpoint.rig.poses));
    if (!checkpoint.rig.frames_late.empty()) chunks.push_back(chunk("late", checkpoint.rig.frames_late));
    if (!checkpoint.rig.readout.empty()) chunks.push_back(chunk("roll", checkpoint.rig.readout));
    {
        const TraceSpan span("write the state");
        voctree::write_nvv(state_path(nvv), checkpoint.tree, chunks, 1);
    }
    checkpoint.tree.weights = std::move(weights);
    checkpoint.first = {};
    checkpoint.second = {};
    return save_compact(nvv, std::move(checkpoint.tree), checkpoint.frame);
}

uint32_t save_compact(const std::filesystem::path& nvv, voctree::VOctree tree, const voctree::WorldFrame& frame) {
    const TraceSpan span("write the clip");
    empty_thin_leaves(tree);
    voctree::drop_empty_leaves(tree);
    make_compact(tree);
    const voctree::ChunkOfFrame chunk(frame);
    voctree::write_nvv(nvv, tree, chunk.views(), 1, voctree::coarse_tree(tree));
    return tree.leaf_count;
}

Checkpoint load_checkpoint(const std::filesystem::path& nvv) {
    const std::filesystem::path path = state_path(nvv);
    std::vector<voctree::NvvChunk> chunks;
    Checkpoint checkpoint;
    checkpoint.tree = voctree::read_nvv(path, &chunks);
    voctree::VOctree& tree = checkpoint.tree;
    checkpoint.run = read_run(path, find_chunk(path, chunks, "run0"), 2 * tree.node_levels);
    const size_t rows = size_t{2} * tree.frames * tree.bases;
    tree.weights = read_floats(path, chunks, "wf32", size_t{tree.leaf_count} * tree.weights_per_leaf());
    checkpoint.first = read_bfloats(path, chunks, "mom1", plane_numbers(tree));
    checkpoint.second = read_bfloats(path, chunks, "mom2", plane_numbers(tree));
    checkpoint.rows_first = read_floats(path, chunks, "row1", rows);
    checkpoint.rows_second = read_floats(path, chunks, "row2", rows);
    checkpoint.use.max_weight = read_floats(path, chunks, "rech", tree.leaf_count);
    checkpoint.use.opacity_sensitivity = read_floats(path, chunks, "pull", tree.leaf_count);
    checkpoint.use.frames =
        read_chunk<uint32_t>(path, chunks, "frms", size_t{(tree.frames + 31) / 32} * tree.leaf_count);
    checkpoint.colours = read_all_colours(path, chunks, tree.frames);
    checkpoint.rig = {read_poses(path, chunks), read_frames(path, chunks, "late", kMostFramesLate),
                      read_frames(path, chunks, "roll", kLongestReadout)};
    return checkpoint;
}

void restore_moments(const gpu::Device& device, const TrainingStep& step, const Checkpoint& checkpoint) {
    const Moments& moments = step.moments();
    upload_bfloat(device, moments.first, checkpoint.first);
    upload_bfloat(device, moments.second, checkpoint.second);
    const auto upload_floats = [&](const gpu::Buffer& buffer, const std::vector<float>& values) {
        gpu::upload(device, buffer, values.data(), values.size() * sizeof(float));
    };
    upload_floats(moments.rows_first, checkpoint.rows_first);
    upload_floats(moments.rows_second, checkpoint.rows_second);
    write_use(device, step.tally(), checkpoint.use);
}

}  // namespace neuvv::training
