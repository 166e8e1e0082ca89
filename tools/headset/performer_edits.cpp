#include "tools/headset/performer_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "edit/operations.h"
#include "tools/headset/arrange.h"
#include "voctree/clip_index.h"

namespace neuvv::headset {

namespace {

// The middle between the feet, in the performer's own space.
glm::dvec3 feet_of(const HeadsetState& state, uint32_t performer) {
    const auto [low, high] = editor::box_of(state, performer);
    return {0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z)};
}

bool refuses_locked(HeadsetState& state, uint32_t node) {
    if (!edit::is_locked(state.editor.file(), node)) return false;
    state.editor.notify("it is locked: unlock it to change it", true);
    return true;
}

}  // namespace

void give_life_size(HeadsetState& state) {
    const auto performer = state.selected_performer();
    if (!performer) return;
    const uint32_t node = state.stage->performers[*performer].node;
    if (refuses_locked(state, node)) return;
    glm::dmat4 world_from_node = state.evaluated.pose.world_from_node[node];
    const glm::dvec3 feet = feet_of(state, *performer), feet_world = world_from_node * glm::dvec4(feet, 1);
    for (int axis = 0; axis < 3; axis++) {
        const double length = glm::length(glm::dvec3(world_from_node[axis]));
        if (!(length > 0)) return;  // an animation makes it flat at this time
        world_from_node[axis] /= length;
    }
    world_from_node[3] += glm::dvec4(feet_world - glm::dvec3(world_from_node * glm::dvec4(feet, 1)), 0);
    move_node_to(state, node, world_from_node);
}

void hide_selected(HeadsetState& state) {
    const auto performer = state.selected_performer();
    if (!performer) return;
    const uint32_t node = state.stage->performers[*performer].node;
    if (state.editor.edit([&](edit::Document& document) { return edit::show_node(document.file, node, false); }))
        state.editor.select({});
}

std::vector<uint32_t> hidden_performers(const HeadsetState& state) {
    std::vector<uint32_t> hidden;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers)
        if (!performer.visible) hidden.push_back(performer.performer);
    return hidden;
}

void show_performer(HeadsetState& state, uint32_t performer) {
    const uint32_t node = state.stage->performers[performer].node;
    const bool done = state.editor.edit([&](edit::Document& document) {
        std::string text = edit::show_node(document.file, node, true);
        for (int32_t above = state.stage->scene.nodes[node].parent; above >= 0;
             above = state.stage->scene.nodes[static_cast<size_t>(above)].parent)
            if (!edit::is_visible(document.file, static_cast<uint32_t>(above)))
                edit::show_node(document.file, static_cast<uint32_t>(above), true);
        return text;
    });
    if (done) state.editor.select(node);
}

void rename_selected(HeadsetState& state, const std::string& name) {
    const auto selected = state.editor.selected();
    if (!selected || name.empty() || name == edit::name_of(state.editor.file(), *selected)) return;
    state.editor.edit([&](edit::Document& document) { return edit::rename_node(document.file, *selected, name); });
}

std::vector<std::filesystem::path> clips_at_hand(const editor::Editor& editor) {
    const stage::StageFile& file = editor.file();
    std::vector<std::filesystem::path> clips = edit::clips_of(file);
    std::error_code error;
    std::vector<std::filesystem::path> beside;
    for (std::filesystem::directory_iterator entry(stage::absolute_path(file.path).parent_path(), error), end;
         !error && entry != end; entry.increment(error)) {
        const std::filesystem::path& path = entry->path();
        const bool is_file = entry->is_regular_file(error);
        const bool is_clip = path.extension() == ".nvv" || (path.extension() == ".nvs" && is_file);
        if (is_clip && (is_file || voctree::is_segmented(path))) beside.push_back(path);
    }
    std::sort(beside.begin(), beside.end());
    for (const std::filesystem::path& clip : beside)
        if (std::find(clips.begin(), clips.end(), clip) == clips.end()) clips.push_back(clip);
    if (clips.size() > kMaxClips) clips.resize(kMaxClips);
    return clips;
}

namespace {

bool preview_new_performer(HeadsetState& state, const NewPerformer& performer) {
    return state.editor.drag([&](edit::Document& document) {
        edit::PerformerEdit edit;
        edit.clip = performer.clip;
        edit::Placement placement;
        placement.matrix = performer.world_from_node;
        return edit::add_performer(document.file, performer.clip.stem().string(), edit, placement);
    });
}

}  // namespace

void add_performer(HeadsetState& state, const std::filesystem::path& clip, const xr::Pose& head) {
    const xr::Pose world = xr::world_from_tracking(state.rig) * head;
    const double yaw_rad = xr::yaw_of(world.rotation);
    const glm::dvec3 before = xr::turn_by(yaw_rad) * glm::dvec3(0, 0, -kNewPerformer_m);
    NewPerformer performer{clip, xr::matrix_of({world.position + before, xr::turn_by(yaw_rad)})};
    performer.world_from_node[3].y = state.floor_m;
    if (state.new_performer && state.new_performer->is_shown) state.editor.end_drag();
    state.new_performer = performer;
}

void land_new_performer(HeadsetState& state, bool is_busy) {
    std::optional<NewPerformer>& performer = state.new_performer;
    if (!performer || !performer->is_read || state.is_behind()) return;
    if (!performer->is_shown) {
        if (is_busy) return;
        const auto node = static_cast<uint32_t>(state.editor.node_count());
        performer->is_shown = preview_new_performer(state, *performer);
        if (!performer->is_shown) return performer.reset();
        return state.editor.select(node);
    }
    NewPerformer shown = *std::exchange(performer, std::nullopt);
    const auto selected = state.selected_performer();
    if (!selected || !state.editor.dragging()) return state.editor.end_drag();
    const glm::dvec3 feet = glm::dmat3(shown.world_from_node) * feet_of(state, *selected);
    shown.world_from_node[3] -= glm::dvec4(feet, 0);
    preview_new_performer(state, shown);
    state.editor.end_drag();
}

std::filesystem::path next_numbered(const std::filesystem::path& path) {
    std::string stem = path.stem().string();
    int number = 1;
    const size_t dash = stem.rfind('-');
    const bool is_numbered = dash != std::string::npos && dash > 0 && stem.size() - dash <= 7 &&
                             stem.size() > dash + 1 &&
                             std::all_of(stem.begin() + static_cast<std::ptrdiff_t>(dash) + 1, stem.end(),
                                         [](unsigned char c) { return std::isdigit(c) != 0; });
    if (is_numbered) {
        number = std::stoi(stem.substr(dash + 1));
        stem.resize(dash);
    }
    std::filesystem::path next;
    do next = path.parent_path() / fmt::format("{}-{}{}", stem, ++number, path.extension().string());
    while (std::filesystem::exists(next));
    return next;
}

}  // namespace neuvv::headset
