#include "tools/headset/state/performer_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "edit/operations.h"
#include "tools/headset/state/arrange.h"
#include "voctree/files/clip.h"

namespace neuvv::headset {

namespace {

// The centre between the feet, in the performer's own space.
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
    for (int axis = 0; axis < 3; ++axis) {
        const double length = glm::length(glm::dvec3(world_from_node[axis]));
        if (!(length > 0)) return;  // an animation makes it flat at this time
        world_from_node[axis] /= length;
    }
    world_from_node[3] += glm::dvec4(feet_world - glm::dvec3(world_from_node * glm::dvec4(feet, 1)), 0);
    move_node_to(state, node, world_from_node);
}

void bring_here(HeadsetState& state, const xr::Pose& head) {
    const auto performer = state.selected_performer();
    if (!performer) return;
    const uint32_t node = state.stage->performers[*performer].node;
    if (refuses_locked(state, node)) return;
    const xr::Pose world = xr::world_from_tracking(state.rig) * head;
    const double yaw_rad = xr::yaw_of(world.rotation);
    const glm::dmat4& was = state.evaluated.pose.world_from_node[node];
    const double front_rad = std::atan2(was[2].x, was[2].z);  // 0: +Z, which faces a user who looks along −Z
    glm::dmat4 is = glm::mat4_cast(xr::turn_by(yaw_rad - front_rad)) * was;
    const glm::dvec3 before = xr::turn_by(yaw_rad) * glm::dvec3(0, 0, -kNewPerformer_m);
    const glm::dvec3 at(world.position.x + before.x, state.floor_m, world.position.z + before.z);
    is[3] += glm::dvec4(at - glm::dvec3(is * glm::dvec4(feet_of(state, *performer), 1)), 0);
    const auto [low, high] = editor::box_of(state, *performer);
    is = on_floor(is, low, high, state.floor_m);
    const glm::dvec3 aside = xr::turn_by(yaw_rad) * glm::dvec3(1, 0, 0);
    is[3] += glm::dvec4(free_shift_m(state, *performer, is, aside) * aside, 0);
    move_node_to(state, node, is);
}

namespace {

// The box around all performers that are seen, in the space of a user who looks along −Z; nullopt where there are none.
std::optional<std::pair<glm::dvec3, glm::dvec3>> ensemble_box(const HeadsetState& state, const xr::Pose& world_user) {
    glm::dvec3 lowest(INFINITY), highest(-INFINITY);
    const xr::Pose user_from_world = xr::inverse(world_user);
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (!performer.visible) continue;
        const auto [low, high] = editor::box_of(state, performer.performer);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 of_box(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                    corner & 4 ? high.z : low.z);
            const glm::dvec3 at = user_from_world * glm::dvec3(performer.world_from_performer * glm::dvec4(of_box, 1));
            lowest = glm::min(lowest, at);
            highest = glm::max(highest, at);
        }
    }
    if (!(lowest.x <= highest.x)) return std::nullopt;
    return std::pair{lowest, highest};
}

// The performers that are seen, but for those that stand on the node of another one.
std::vector<uint32_t> outermost_nodes(const HeadsetState& state) {
    std::vector<uint32_t> nodes;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers)
        if (performer.visible) nodes.push_back(state.stage->performers[performer.performer].node);
    const std::vector<uint32_t> all = nodes;
    std::erase_if(nodes, [&](uint32_t node) {
        for (int32_t above = state.stage->scene.nodes[node].parent; above >= 0;
             above = state.stage->scene.nodes[static_cast<size_t>(above)].parent)
            if (std::ranges::find(all, static_cast<uint32_t>(above)) != all.end()) return true;
        return false;
    });
    return nodes;
}

}  // namespace

void fit_to_room(HeadsetState& state, const xr::Pose& head, glm::dvec2 room_m) {
    const xr::Pose world = xr::world_from_tracking(state.rig) * head;
    const xr::Pose user{{world.position.x, state.floor_m, world.position.z}, xr::turn_by(xr::yaw_of(world.rotation))};
    const auto box = ensemble_box(state, user);
    if (!box) return state.editor.notify("nobody is seen on the stage", true);
    const glm::dvec3 size = box->second - box->first, centre = 0.5 * (box->first + box->second);
    const double scale = std::min({1.0, room_m.x / size.x, room_m.y / size.z, kRoomHeight_m / size.y});
    const glm::dvec3 to(0, 0, -(kNewPerformer_m + 0.5 * scale * size.z));
    const glm::dmat4 moved = glm::translate(glm::dmat4(1), to) * glm::scale(glm::dmat4(1), glm::dvec3(scale)) *
                             glm::translate(glm::dmat4(1), -glm::dvec3(centre.x, box->first.y, centre.z));
    const glm::dmat4 world_from_user = xr::matrix_of(user);
    const glm::dmat4 change = world_from_user * moved * glm::inverse(world_from_user);
    state.editor.edit([&](edit::Document& document) {
        for (const uint32_t node : outermost_nodes(state)) {
            edit::Placement placement;
            placement.to =
                glm::inverse(world_from_parent(state, node)) * change * state.evaluated.pose.world_from_node[node];
            edit::place_node(document.file, node, placement);
        }
        return fmt::format("the performers are brought here, {:.0f} % as large", 100 * scale);
    });
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
        if (voctree::has_clip_ending(path) && (is_file || voctree::is_segmented(path))) beside.push_back(path);
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
    const glm::dvec3 aside = glm::normalize(glm::dvec3(shown.world_from_node[0]));
    shown.world_from_node[3] += glm::dvec4(free_shift_m(state, *selected, shown.world_from_node, aside) * aside, 0);
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
