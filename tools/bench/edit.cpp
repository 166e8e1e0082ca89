// neuvv-bench edit: the time of a step of a drag on an empty stage, and on one with large embedded buffers.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/formats/json.h"
#include "base/text.h"
#include "edit/operations.h"
#include "editor/editor.h"
#include "stage/stage.h"
#include "tools/bench/measure.h"
#include "tools/options.h"
#include "tools/report.h"

namespace neuvv::bench {

namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::ordered_json;

struct EditOptions {
    double megabytes = 50;
    uint32_t steps = 100;
    bool json = false;
};

struct EditCost {
    uint64_t stage_bytes = 0;               // size of the stage's file
    std::vector<double> edit_ms, stage_ms;  // of each step: editing the document, making a stage of it
    uint64_t history_bytes = 0;             // after `steps` edits

    std::vector<double> total_ms() const {
        std::vector<double> total = edit_ms;
        for (size_t i = 0; i < total.size(); ++i) total[i] += stage_ms[i];
        return total;
    }
};

// Adds a wavy square whose positions, normals and indices take about so many bytes, in a data URI.
void add_terrain(ordered_json& json, double bytes) {
    constexpr double kBytesAVertex = 48;  // two vectors, and six indices of two triangles
    const auto side = static_cast<uint32_t>(std::max(2.0, std::sqrt(bytes / kBytesAVertex)));
    std::vector<float> vectors;
    for (uint32_t i = 0; i < side * side; ++i) {
        const auto x = static_cast<float>(i % side), z = static_cast<float>(i / side);
        vectors.insert(vectors.end(), {0.01f * x, 0.1f * std::sin(0.1f * x), 0.01f * z});
    }
    for (uint32_t i = 0; i < side * side; ++i) vectors.insert(vectors.end(), {0, 1, 0});
    std::vector<uint32_t> indices;
    for (uint32_t z = 0; z + 1 < side; ++z)
        for (uint32_t x = 0; x + 1 < side; ++x) {
            const uint32_t corner = z * side + x;
            indices.insert(indices.end(),
                           {corner, corner + side, corner + 1, corner + 1, corner + side, corner + side + 1});
        }
    const size_t vector_bytes = vectors.size() * sizeof(float), index_bytes = indices.size() * sizeof(uint32_t);
    std::vector<uint8_t> buffer(vector_bytes + index_bytes);
    std::memcpy(buffer.data(), vectors.data(), vector_bytes);
    std::memcpy(buffer.data() + vector_bytes, indices.data(), index_bytes);

    const size_t first_view = json["bufferViews"].size(), first = json["accessors"].size();
    const auto view = [&](size_t offset, size_t length) {
        json["bufferViews"].push_back(
            {{"buffer", json["buffers"].size()}, {"byteOffset", offset}, {"byteLength", length}});
    };
    view(0, vector_bytes / 2);
    view(vector_bytes / 2, vector_bytes / 2);
    view(vector_bytes, index_bytes);
    for (size_t i = 0; i < 2; ++i)
        json["accessors"].push_back(
            {{"bufferView", first_view + i}, {"componentType", 5126}, {"count", side * side}, {"type", "VEC3"}});
    json["accessors"].push_back(
        {{"bufferView", first_view + 2}, {"componentType", 5125}, {"count", indices.size()}, {"type", "SCALAR"}});
    json["buffers"].push_back(
        {{"byteLength", buffer.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer)}});
    json["scenes"][0]["nodes"].push_back(json["nodes"].size());
    json["nodes"].push_back({{"name", "terrain"}, {"mesh", json["meshes"].size()}});
    json["meshes"].push_back(
        {{"name", "terrain"},
         {"primitives", {{{"attributes", {{"POSITION", first}, {"NORMAL", first + 1}}}, {"indices", first + 2}}}}});
}

// An empty stage, or one with such a square. It is never written.
stage::StageFile stage_of(double bytes) {
    const stage::StageFile empty = edit::new_stage("bench.gltf");
    if (bytes == 0) return empty;
    ordered_json json = ordered_json::parse(empty.saved->bytes);
    add_terrain(json, bytes);
    return stage::make_stage_file("bench.gltf", json.dump(1));
}

editor::Editor::Operation moved_to(uint32_t node, double x) {
    return [node, x](edit::Document& document) {
        edit::Placement placement;
        placement.at = glm::dvec3(x, 0, 0);
        return edit::place_node(document.file, node, placement);
    };
}

// Does what the viewer does at each move of the mouse: its main thread edits the document and copies it, and the render
// thread makes a stage of the copy.
EditCost measure(double bytes, uint32_t steps) {
    EditCost cost;
    editor::Editor editor;
    editor.open({stage_of(bytes), {}, {}}, false);
    cost.stage_bytes = editor.file().saved->bytes.size();
    auto stage = std::make_shared<const stage::Stage>(stage::make_stage(editor.file()));
    const uint32_t node = edit::find_node(editor.file(), "key");
    std::shared_ptr<const edit::Document> document;
    for (uint32_t step = 0; step < steps; ++step) {
        expect_not_stopped();
        Clock::time_point from = Clock::now();
        editor.drag(moved_to(node, 0.01 * (step + 1)));
        document = std::make_shared<const edit::Document>(editor.document());
        cost.edit_ms.push_back(milliseconds_since(from));
        from = Clock::now();
        stage = std::make_shared<const stage::Stage>(stage::make_stage(document->file, stage.get()));
        cost.stage_ms.push_back(milliseconds_since(from));
    }
    editor.end_drag();
    for (uint32_t step = 1; step < steps; ++step) editor.edit(moved_to(node, -0.01 * step));
    cost.history_bytes = editor.history().extra_bytes(editor.document());
    return cost;
}

ordered_json json_of(const EditCost& cost) {
    const std::vector<double> total = cost.total_ms();
    return {{"stage_bytes", cost.stage_bytes},   {"median_ms", median(total)},
            {"worst_ms", quantile(total, 1)},    {"edit_ms", median(cost.edit_ms)},
            {"stage_ms", median(cost.stage_ms)}, {"history_bytes", cost.history_bytes}};
}

void print(const char* name, const EditCost& cost) {
    const std::vector<double> total = cost.total_ms();
    fmt::print("{:<8} {:>10} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f} {:>12}\n", name, tools::size_text(cost.stage_bytes),
               median(total), quantile(total, 1), median(cost.edit_ms), median(cost.stage_ms),
               tools::size_text(cost.history_bytes));
}

void run_edit(const EditOptions& options) {
    const EditCost empty = measure(0, options.steps), large = measure(options.megabytes * 1e6, options.steps);
    const double ratio = median(large.total_ms()) / median(empty.total_ms());
    if (options.json) {
        fmt::print("{}", json_text({{"megabytes", options.megabytes},
                                    {"steps", options.steps},
                                    {"empty", json_of(empty)},
                                    {"large", json_of(large)},
                                    {"ratio", ratio}}));
        return;
    }
    fmt::print("{} steps of a drag, in milliseconds\n", options.steps);
    fmt::print("{:<8} {:>10} {:>9} {:>9} {:>9} {:>9} {:>12}\n", "stage", "file", "median", "worst", "edit", "stage",
               "history");
    print("empty", empty);
    print("large", large);
    fmt::print("a step on the large stage takes {:.2f} times as long as on the empty one\n", ratio);
}

}  // namespace

void add_edit(tools::Command app, const tools::CommonOptions&) {
    tools::Command verb = app.add_verb("edit", "A step of a drag, on an empty stage and on a large one");
    const auto options = std::make_shared<EditOptions>();
    verb.add_option("--megabytes", options->megabytes, "Of the large stage's buffer, which its file embeds")
        .number_between(0.001, 50)
        .show_default();
    verb.add_option("--steps", options->steps, "Moves of the mouse, and then as many edits")
        .in_range(2, 100)
        .show_default();
    verb.add_flag("--json", options->json, "Print JSON");
    verb.footer(
        {"Drags the light of a new stage, as the viewer does: `edit` is the operation and a copy of the "
         "document, `stage`\nwhat the render thread makes of that copy before it draws. `history` is the "
         "memory that undoing all steps needs beyond\nthe document. The large stage has a mesh in a data "
         "URI. No device is used.",
         tools::kExamplesHead, "  neuvv-bench edit\n  neuvv-bench edit --megabytes 10 --json"});
    verb.callback([options] { run_edit(*options); });
}

}  // namespace neuvv::bench
