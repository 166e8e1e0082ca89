// neuvv info: what a clip or a stage holds.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/formats/json.h"
#include "editor/open_file.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/publish/stream_info.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/stage/stage_verbs.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"
#include "voctree/files/chunk_file.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_index.h"
#include "voctree/files/half.h"
#include "voctree/files/nvv.h"

namespace neuvv::tools {

namespace {

struct InfoOptions {
    std::string file;
    bool json = false, check = false, memory = false;
};

uint32_t weights_per_leaf(const voctree::NvvHeader& header) {
    return 2 * header.bases + 3 * hh_count(header.hh_degree);
}

double clip_seconds(const voctree::NvvHeader& header) {
    return header.frames / static_cast<double>(header.fps);
}

// A PlenOctree as the clip that it is played as; it has no version and no chunks.
voctree::NvvSummary summary_of_plenoctree(const std::string& file) {
    const voctree::VOctree tree = voctree::read_clip(file, voctree::PlenoctreeColours::kAsStored);
    uint32_t infinite = 0;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) infinite += *tree.leaf(leaf) == voctree::kMaxHalf ? 1 : 0;
    if (infinite > 0) say("neuvv: leaves whose density is limited to {} per metre: {}\n", voctree::kMaxHalf, infinite);
    voctree::NvvSummary summary;
    summary.file_bytes = std::filesystem::file_size(file);
    summary.header = voctree::header_of(tree);
    return summary;
}

bool is_nvv(const voctree::NvvSummary& summary) {
    return summary.version != 0;
}

nlohmann::ordered_json json_of(const InfoOptions& options, const voctree::NvvSummary& summary) {
    const voctree::NvvHeader& header = summary.header;
    const glm::vec3 low = header.box_min, high = header.box_min + header.box_size;
    auto chunks = nlohmann::ordered_json::array();
    for (const voctree::NvvSummary::Chunk& chunk : summary.chunks)
        chunks.push_back({{"name", chunk.name}, {"raw_bytes", chunk.raw_bytes}, {"stored_bytes", chunk.stored_bytes}});
    return {{"file", options.file},
            {"format", is_nvv(summary) ? "nvv" : "PlenOctree"},
            {"version", is_nvv(summary) ? nlohmann::ordered_json(summary.version) : nullptr},
            {"bytes", summary.file_bytes},
            {"box", {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}}},
            {"capture", capture_json(options.file)},
            {"node_levels", header.node_levels},
            {"cells_per_side", 1u << (2 * header.node_levels)},
            {"nodes", header.node_count},
            {"leaves", header.leaf_count},
            {"bases", header.bases},
            {"hh_degree", header.hh_degree},
            {"weights_per_leaf", weights_per_leaf(header)},
            {"frames", header.frames},
            {"fps", header.fps},
            {"seconds", clip_seconds(header)},
            {"chunks", chunks},
            {"checked", options.check}};
}

void print(const InfoOptions& options, const voctree::NvvSummary& summary) {
    const voctree::NvvHeader& header = summary.header;
    const glm::vec3 low = header.box_min, high = header.box_min + header.box_size;
    tell("{}: {}, {}\n", options.file, is_nvv(summary) ? fmt::format(".nvv version {}", summary.version) : "PlenOctree",
         size_text(summary.file_bytes));
    tell("clip    {} frames at {} fps, {:.2f} s\n", header.frames, header.fps, clip_seconds(header));
    tell("box     ({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, {:.3f}) m\n", low.x, low.y, low.z, high.x, high.y,
         high.z);
    tell("{}", capture_line(options.file));
    tell("octree  {} leaves in {} nodes of {} levels, up to {} cells a side\n", header.leaf_count, header.node_count,
         header.node_levels, 1u << (2 * header.node_levels));
    tell("leaf    {} weights: C = {} twice, n_max = {} ({} functions) for R, G, B\n", weights_per_leaf(header),
         header.bases, header.hh_degree, hh_count(header.hh_degree));
    for (const voctree::NvvSummary::Chunk& chunk : summary.chunks) {
        const double share =
            static_cast<double>(chunk.stored_bytes) / std::max(1.0, static_cast<double>(chunk.raw_bytes));
        tell("{}    {:>10} stored as {:>10}, {:.0f} %\n", chunk.name, size_text(chunk.raw_bytes),
             size_text(chunk.stored_bytes), 100 * share);
    }
    if (options.check) tell("checked: whole and sound\n");
    if (const auto claim = training::claim_of(options.file))
        tell("training: {} trains it, {:.0f} % done; this is its last checkpoint\n", claim->owner,
             100 * claim->fraction);
}

// Adds to a segment's JSON how far its training is, where it is not finished; returns that for a line.
std::string add_training(const voctree::ClipSegment& segment, nlohmann::ordered_json& json) {
    const std::string text = training::unfinished_training(segment.file);
    if (text.empty()) return "";
    const auto claim = training::claim_of(segment.file);
    json["training"] = claim ? nlohmann::ordered_json{{"owner", claim->owner}, {"fraction", claim->fraction}}
                             : nlohmann::ordered_json{{"owner", nullptr}};
    return "; " + text;
}

// What is not as it should be of a segmented clip.
struct SegmentProblems {
    bool damaged = false;
    size_t not_there = 0;  // segments that have not been trained so far
    bool in_training = false;

    void expect_none(const std::string& file) const {
        if (damaged) throw InputError(file, "", "has segments that cannot be played", "train them again");
        if (not_there > 0 && !in_training)
            throw InputError(file, "",
                             fmt::format("has {} segments that are not trained, and nobody trains", not_there),
                             "the command that began the clip trains them with --resume");
    }
};

// Prints what a segmented clip holds: its segments, of which those that cannot be read are named.
SegmentProblems print_segments(const InfoOptions& options) {
    const voctree::ClipIndex index = voctree::read_clip_index(options.file);
    auto json = nlohmann::ordered_json::array();
    uint64_t bytes = 0, leaves = 0;
    SegmentProblems problems;
    std::string lines;
    for (const voctree::ClipSegment& segment : index.segments) {
        json.push_back(
            {{"file", segment.file.filename().string()}, {"first", segment.first}, {"frames", segment.frames}});
        if (segment.overlap > 0) json.back()["overlap"] = segment.overlap;
        lines += fmt::format("frames {:>6} to {:>6}  {:<12}", segment.first, segment.end() - 1,
                             segment.file.filename().string());
        std::error_code ignored;
        problems.in_training = problems.in_training || training::claim_of(segment.file).has_value();
        try {
            if (!std::filesystem::exists(segment.file, ignored)) {
                ++problems.not_there;
                json.back()["problem"] = "not trained so far";
                lines += " is not trained so far" + add_training(segment, json.back()) + "\n";
                continue;
            }
            const voctree::NvvSummary summary = voctree::summarise_nvv(segment.file);
            if (options.check) voctree::read_segment(segment);
            json.back().update({{"bytes", summary.file_bytes}, {"leaves", summary.header.leaf_count}});
            lines += fmt::format(" {:>10}  {} leaves", size_text(summary.file_bytes), summary.header.leaf_count);
            bytes += summary.file_bytes;
            leaves += summary.header.leaf_count;
        } catch (const InputError& problem) {
            problems.damaged = true;
            json.back()["problem"] = message_of(problem);
            lines += fmt::format(" cannot be played: {}", message_of(problem));
        }
        lines += add_training(segment, json.back()) + "\n";
    }
    const double seconds = index.frames() / static_cast<double>(index.fps);
    if (options.json) {
        tell("{}", json_text({{"file", options.file},
                              {"format", "segmented nvv"},
                              {"bytes", bytes},
                              {"leaves", leaves},
                              {"frames", index.frames()},
                              {"fps", index.fps},
                              {"seconds", seconds},
                              {"capture", capture_json(options.file)},
                              {"segments", json},
                              {"checked", options.check}}));
        return problems;
    }
    tell("{}: clip in {} segments, {}\nclip    {} frames at {} fps, {:.2f} s\n{}{}", options.file,
         index.segments.size(), size_text(bytes), index.frames(), index.fps, seconds, capture_line(options.file),
         lines);
    return problems;
}

void print_file(const InfoOptions& options, const voctree::NvvSummary& summary) {
    if (options.check && is_nvv(summary)) {  // a PlenOctree has been read whole already
        voctree::read_nvv_coarse(options.file);
        voctree::read_nvv(options.file);
    }
    if (options.json)
        tell("{}", json_text(json_of(options, summary)));
    else
        print(options, summary);
}

// Throws InputError, which names the verb that tells of it, for a layer of paint and for a folder that is no clip.
void expect_clip(const std::string& file) {
    std::error_code error;
    if (voctree::content_of(file) == voctree::FileContent::kPaint)
        throw InputError(file, "", "is a layer of paint",
                         fmt::format("`neuvv paint info SCENE {}` says what it holds", file));
    if (!std::filesystem::is_directory(file, error) || voctree::is_segmented(file)) return;
    throw InputError(file, "", "is a folder, and no clip in segments",
                     fmt::format("`neuvv dataset {}` says what a folder of images holds", file));
}

void run(const InfoOptions& options, const CommonOptions& common) {
    if (editor::has_stage_ending(options.file)) {
        if (options.check)
            throw InputError("--check", options.file, "is for clips", "leave it out: stages are always checked");
        StageInfoOptions stage;
        stage.stage = options.file;
        stage.json = options.json;
        stage.memory = options.memory;
        return print_stage_info(stage, common);
    }
    if (options.memory) throw InputError("--memory", options.file, "is for stages", "leave it out");
    expect_clip(options.file);
    switch (voctree::kind_of(options.file)) {
        case voctree::ClipKind::kStream:
            return print_stream_info(options.file, options.json, options.check);
        case voctree::ClipKind::kSegments: {
            const SegmentProblems problems = print_segments(options);
            if (options.check) problems.expect_none(options.file);
            return;
        }
        case voctree::ClipKind::kPlenoctree:
            return print_file(options, summary_of_plenoctree(options.file));
        case voctree::ClipKind::kNvv:
            print_file(options, voctree::summarise_nvv(options.file));
    }
}

}  // namespace

void add_info(Command app, CommonOptions& common) {
    Command verb = app.add_verb("info", "Say what a clip holds, or who and what is on a stage");
    const auto options = std::make_shared<InfoOptions>();
    verb.add_option(
            "file", options->file,
            "A .nvv, a .nvs, the .npz of a PlenOctree, or a stage: .gltf or .glb (`neuvv stage info` tells it at "
            "any time)")
        .required();
    verb.add_flag("--json", options->json, "Print JSON");
    verb.add_flag("--check", options->check, "Read all of it: checksums, topology, numbers (exit code 2 if damaged)");
    verb.add_flag("--memory", options->memory, "Of a stage: measure what its clips take on a device, each once");
    verb.footer({kExamplesHead + 2,
                 "  neuvv info work/performer.nvv\n"
                 "  neuvv info work/performer.nvv --check\n"
                 "  neuvv info work/performer.nvv --json | jq .leaves\n"
                 "  neuvv info work/show.gltf --memory"});
    verb.callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::tools
