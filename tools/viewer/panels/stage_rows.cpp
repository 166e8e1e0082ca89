#include "tools/viewer/panels/stage_rows.h"

namespace neuvv::viewer {

namespace {

void count_below(std::vector<StageRow>& rows) {
    std::vector<size_t> above;  // the ancestors of the row, by depth
    for (size_t row = 0; row <= rows.size(); ++row) {
        const size_t depth = row < rows.size() ? rows[row].depth : 0;
        for (; above.size() > depth; above.pop_back())
            rows[above.back()].descendants = static_cast<uint32_t>(row - above.back() - 1);
        above.push_back(row);
    }
}

}  // namespace

std::vector<StageRow> stage_rows(const stage::StageFile& file) {
    const size_t count = edit::node_count(file);
    struct Next {
        uint32_t node, depth;
        bool ancestors_visible;
    };
    std::vector<Next> next;  // a stack: the last one becomes the next row
    const auto push = [&](const std::vector<uint32_t>& nodes, uint32_t depth, bool ancestors_visible) {
        for (size_t i = nodes.size(); i-- > 0;) next.push_back({nodes[i], depth, ancestors_visible});
    };
    push(edit::scene_roots(file), 0, true);
    std::vector<StageRow> rows;
    while (!next.empty() && rows.size() < count) {
        const Next at = next.back();
        next.pop_back();
        StageRow& row = rows.emplace_back();
        row.node = at.node;
        row.depth = at.depth;
        row.kind = edit::kind_of(file, at.node);
        row.title = edit::node_title(file, at.node);
        row.visible = edit::is_visible(file, at.node);
        row.ancestors_visible = at.ancestors_visible;
        row.locked = edit::is_locked(file, at.node);
        row.has_sound = edit::has_sound(file, at.node);
        push(edit::children_of(file, at.node), at.depth + 1, at.ancestors_visible && row.visible);
    }
    count_below(rows);
    return rows;
}

std::vector<uint32_t> listed_rows(const std::vector<StageRow>& rows, const std::set<std::string>& closed) {
    std::vector<uint32_t> open;
    for (uint32_t row = 0; row < rows.size(); ++row) {
        open.push_back(row);
        if (closed.contains(rows[row].title)) row += rows[row].descendants;
    }
    return open;
}

std::optional<uint32_t> row_of(const std::vector<StageRow>& rows, uint32_t node) {
    for (uint32_t row = 0; row < rows.size(); ++row)
        if (rows[row].node == node) return row;
    return {};
}

void open_ancestors(const std::vector<StageRow>& rows, uint32_t row, std::set<std::string>& closed) {
    for (uint32_t above = 0; above < row; ++above)
        if (above + rows[above].descendants >= row) closed.erase(rows[above].title);
}

std::optional<std::string> locked_within(const std::vector<StageRow>& rows, uint32_t row) {
    for (uint32_t i = row; i <= row + rows[row].descendants; ++i)
        if (rows[i].locked) return rows[i].title;
    return {};
}

}  // namespace neuvv::viewer
