#include <fmt/format.h>

#include <algorithm>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <numbers>

#include "base/error.h"
#include "edit/document.h"
#include "edit/operations.h"
#include "edit/time_edit.h"
#include "voctree/files/clip.h"

namespace neuvv::edit {

namespace {

// Throws InputError where copies cannot be placed without moving the original, too.
void expect_copyable(const stage::StageFile& file, const std::vector<uint32_t>& family) {
    const std::string place = fmt::format("/nodes/{}", family[0]);
    if (is_animated(file, family[0]))
        throw InputError(
            file.path.string(), place,
            fmt::format("{} is animated: its copies would stand where it stands", title_of(file, family[0])),
            "put it below a node that is not, and duplicate that");
    for (const uint32_t node : family)
        if (file.json["nodes"][node].contains("skin"))
            throw InputError(file.path.string(), place,
                             fmt::format("{} has a skin, which follows its joints alone", title_of(file, node)),
                             "duplicate it where it was made");
}

// The list that contains the node: its parent's children, or the scene's roots; null where it is in neither.
ordered_json* siblings_of(stage::StageFile& file, uint32_t node) {
    const auto holds = [&](ordered_json& owner, const char* name) {
        if (!owner.contains(name) || !owner[name].is_array()) return false;
        for (const ordered_json& index : owner[name])
            if (index == node) return true;
        return false;
    };
    for (ordered_json& parent : file.json.edit("nodes"))
        if (holds(parent, "children")) return &parent["children"];
    ordered_json& scene = scene_of(file);
    return holds(scene, "nodes") ? &scene["nodes"] : nullptr;
}

LocalTransform copy_transform(const LocalTransform& first, const CopySettings& settings, uint32_t copy) {
    if (settings.pattern == CopyPattern::kRow) {
        LocalTransform transform = first;
        const glm::dvec3 step(settings.distance_m * copy, 0, 0);
        transform.translation += step;
        transform.matrix[3] += glm::dvec4(step, 0);
        return transform;
    }
    glm::dvec3 front = first.has_matrix ? glm::dvec3(first.matrix[2]) : first.rotation * glm::dvec3(0, 0, 1);
    front.y = 0;
    front = glm::length(front) > 1e-9 ? glm::normalize(front) : glm::dvec3(0, 0, 1);
    const double angle_rad = settings.pattern == CopyPattern::kRing
                                 ? 2 * std::numbers::pi * copy / (settings.count + 1.0)
                                 : glm::radians(settings.arc_deg) * copy / settings.count;
    return turned_about(first, position_of(first) - settings.distance_m * front, angle_rad);
}

glm::dmat4 matrix_of(const LocalTransform& transform) {
    if (transform.has_matrix) return transform.matrix;
    return glm::translate(glm::dmat4(1), transform.translation) * glm::mat4_cast(transform.rotation) *
           glm::scale(glm::dmat4(1), transform.scale);
}

// The performer's time map, resolved for its clip.
stage::Timeline timeline_of(const stage::StageFile& file, uint32_t node) {
    const std::filesystem::path clip = clip_of(file, node);
    const ordered_json& performer = performer_of(file, node);
    const std::string name = file.path.string(), place = title_of(file, node) + ": time";
    const stage::TimeMap map = stage::time_map_of(performer.value("time", ordered_json::array()), name, place);
    voctree::ClipHeader header{};
    try {
        header = voctree::read_clip_header(clip);
    } catch (const InputError& problem) {
        throw InputError(name, title_of(file, node), problem.cause(), "copies that are later need its clip");
    }
    return stage::timeline_of(map, header.frames, static_cast<double>(header.fps), name, place);
}

// Makes a performer's copy later and faster spinning.
void stagger(ordered_json& performer, const CopySettings& settings, const stage::Timeline& timeline, uint32_t copy) {
    const stage::ClipTime by = stagger_offset(timeline, {settings.stagger.value * copy, settings.stagger.frames});
    if (by.value != 0) list_in(performer, "time").push_back({{"operator", "offset"}, {"by", stage::text_of(by)}});
    if (settings.spin_step != 0) performer["spin"] = performer.value("spin", 0.0) + settings.spin_step * copy;
}

// Copies the animation channels that move nodes below the copied node.
void copy_channels(stage::StageFile& file, const std::map<uint32_t, uint32_t>& copies) {
    if (!file.json.contains("animations")) return;
    for (ordered_json& animation : file.json.edit("animations")) {
        ordered_json added = ordered_json::array();
        for (const ordered_json& channel : animation.value("channels", ordered_json::array())) {
            if (!channel.contains("target") || !channel["target"].contains("node")) continue;
            const std::optional<uint64_t> target = index_of(channel["target"]["node"]);
            const auto copy = target ? copies.find(static_cast<uint32_t>(*target)) : copies.end();
            if (copy == copies.end()) continue;
            added.push_back(channel);
            added.back()["target"]["node"] = copy->second;
        }
        for (ordered_json& channel : added) animation["channels"].push_back(std::move(channel));
    }
}

uint32_t copy_family(stage::StageFile& file, const std::vector<uint32_t>& family, FreeNames& names) {
    std::map<uint32_t, uint32_t> copies;
    for (const uint32_t node : family) {
        ordered_json copy = file.json["nodes"][node];
        if (copy.contains("name") && copy["name"].is_string())
            copy["name"] = names.take(copy["name"].get<std::string>());
        copies[node] = static_cast<uint32_t>(file.json["nodes"].size());
        file.json.edit("nodes").push_back(std::move(copy));
    }
    for (const auto& [node, copy] : copies) {
        ordered_json& json = file.json.edit("nodes")[copy];
        if (!json.contains("children")) continue;
        for (ordered_json& child : json["children"]) child = copies.at(child.get<uint32_t>());
    }
    copy_channels(file, copies);
    return copies.at(family[0]);
}

std::string duplicate(stage::StageFile& file, uint32_t node, const CopySettings& settings) {
    const std::string title = title_of(file, node);
    const LocalTransform first = local_transform_of(node_of(file, node));
    const std::vector<uint32_t> family = family_of(file, node);
    expect_copyable(file, family);
    siblings_of(file, node);  // adds a scene where there is none, before there are copies that it would list
    FreeNames names(file);
    std::vector<uint32_t> copies;
    const stage::Timeline timeline = settings.stagger.value != 0 ? timeline_of(file, node) : stage::Timeline{};
    for (uint32_t copy = 1; copy <= settings.count; ++copy) {
        const uint32_t index = copies.emplace_back(copy_family(file, family, names));
        set_local_transform(node_of(file, index), copy_transform(first, settings, copy));
        if (ordered_json* performer = find_extension(node_of(file, index), stage::kPerformerExtension))
            stagger(*performer, settings, timeline, copy);
    }
    if (ordered_json* siblings = siblings_of(file, node))
        for (const uint32_t index : copies) siblings->push_back(index);
    if (settings.count == 1) return fmt::format("{}: a copy", title);
    return fmt::format("{}: {} more", title, settings.count);
}

bool is_possible_count(uint32_t copies) {
    return copies > 0 && copies <= kMaxCopies;
}

}  // namespace

std::vector<glm::dmat4> copy_transforms(const stage::StageFile& file, uint32_t node, const CopySettings& settings) {
    const LocalTransform first = local_transform_of(node_of(file, node));
    std::vector<glm::dmat4> transforms;
    for (uint32_t copy = 1; copy <= settings.count && is_possible_count(settings.count); ++copy)
        transforms.push_back(matrix_of(copy_transform(first, settings, copy)));
    return transforms;
}

std::string duplicate_node(stage::StageFile& file, uint32_t node, const CopySettings& settings) {
    node_of(file, node);
    if (!is_possible_count(settings.count))
        throw InputError(file.path.string(), "count", fmt::format("{} is no number of copies", settings.count),
                         fmt::format("choose from 1 to {}", kMaxCopies));
    if ((settings.stagger.value != 0 || settings.spin_step != 0) &&
        !find_extension(node_of(file, node), stage::kPerformerExtension))
        throw InputError(file.path.string(), fmt::format("/nodes/{}", node),
                         fmt::format("{} is no performer: it has no time and no spin", title_of(file, node)),
                         "leave them out");
    return all_or_nothing(file, [&] { return duplicate(file, node, settings); });
}

}  // namespace neuvv::edit
