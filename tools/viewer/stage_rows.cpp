#include "tools/viewer/stage_rows.h"

#include <fmt/format.h>

#include "edit/operations.h"

namespace neuvv::viewer {

namespace {

using nlohmann::ordered_json;

bool has_extension(const ordered_json& node, const char* name) {
    const auto extensions = node.find("extensions");
    return extensions != node.end() && extensions->is_object() && extensions->contains(name);
}

NodeKind kind_of(const ordered_json& node) {
    if (has_extension(node, stage::kPerformerExtension)) return NodeKind::kPerformer;
    if (has_extension(node, "KHR_lights_punctual")) return NodeKind::kLight;
    if (node.contains("camera")) return NodeKind::kCamera;
    if (node.contains("mesh")) return NodeKind::kMesh;
    return NodeKind::kGroup;
}

std::vector<uint32_t> indices_in(const ordered_json& owner, const char* name) {
    std::vector<uint32_t> indices;
    if (const auto list = owner.find(name); list != owner.end())
        for (const ordered_json& index : *list) indices.push_back(index.get<uint32_t>());
    return indices;
}

// Of the scene; without one, all nodes that hang on none.
std::vector<uint32_t> roots_of(const ordered_json& json, size_t nodes) {
    if (json.contains("scenes") && !json["scenes"].empty())
        return indices_in(json["scenes"].at(json.value("scene", size_t{0})), "nodes");
    std::vector<bool> hangs(nodes);
    for (size_t node = 0; node < nodes; node++)
        for (const uint32_t child : indices_in(json["nodes"][node], "children")) hangs.at(child) = true;
    std::vector<uint32_t> roots;
    for (uint32_t node = 0; node < nodes; node++)
        if (!hangs[node]) roots.push_back(node);
    return roots;
}

void count_below(std::vector<StageRow>& rows) {
    std::vector<size_t> above;  // of the row, one a depth
    for (size_t row = 0; row <= rows.size(); row++) {
        const size_t depth = row < rows.size() ? rows[row].depth : 0;
        for (; above.size() > depth; above.pop_back())
            rows[above.back()].below = static_cast<uint32_t>(row - above.back() - 1);
        above.push_back(row);
    }
}

}  // namespace

std::vector<StageRow> stage_rows(const stage::StageFile& file) {
    const size_t count = file.json.contains("nodes") ? file.json["nodes"].size() : 0;
    struct Next {
        uint32_t node, depth;
        bool shown_above;
    };
    std::vector<Next> next;  // the last is the next row
    const auto push = [&](const std::vector<uint32_t>& nodes, uint32_t depth, bool shown_above) {
        for (size_t i = nodes.size(); i-- > 0;) next.push_back({nodes[i], depth, shown_above});
    };
    push(roots_of(file.json, count), 0, true);
    std::vector<StageRow> rows;
    while (!next.empty() && rows.size() < count) {
        const Next at = next.back();
        next.pop_back();
        const ordered_json& node = file.json["nodes"].at(at.node);
        StageRow& row = rows.emplace_back();
        row.node = at.node;
        row.depth = at.depth;
        row.kind = kind_of(node);
        if (const auto name = node.find("name"); name != node.end() && name->is_string()) row.title = *name;
        if (row.title.empty()) row.title = fmt::format("node {}", at.node);
        row.shown = edit::is_shown(file, at.node);
        row.shown_above = at.shown_above;
        row.locked = edit::is_locked(file, at.node);
        push(indices_in(node, "children"), at.depth + 1, at.shown_above && row.shown);
    }
    count_below(rows);
    return rows;
}

std::vector<uint32_t> open_rows(const std::vector<StageRow>& rows, const std::set<std::string>& closed) {
    std::vector<uint32_t> open;
    for (uint32_t row = 0; row < rows.size(); row++) {
        open.push_back(row);
        if (closed.contains(rows[row].title)) row += rows[row].below;
    }
    return open;
}

std::optional<uint32_t> row_of(const std::vector<StageRow>& rows, uint32_t node) {
    for (uint32_t row = 0; row < rows.size(); row++)
        if (rows[row].node == node) return row;
    return {};
}

void open_above(const std::vector<StageRow>& rows, uint32_t row, std::set<std::string>& closed) {
    for (uint32_t above = 0; above < row; above++)
        if (above + rows[above].below >= row) closed.erase(rows[above].title);
}

std::optional<std::string> locked_within(const std::vector<StageRow>& rows, uint32_t row) {
    for (uint32_t i = row; i <= row + rows[row].below; i++)
        if (rows[i].locked) return rows[i].title;
    return {};
}

}  // namespace neuvv::viewer
