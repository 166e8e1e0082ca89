#include "edit/operations.h"

#include <fmt/format.h>

#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "edit/document.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::edit {

namespace {

std::string with_commas(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
    return text;
}

// Translation, rotation and scale of the matrix; nullopt where it is sheared or flat.
std::optional<LocalTransform> decomposed(const glm::dmat4& matrix) {
    constexpr double kSheared = 1e-6;
    LocalTransform transform;
    transform.translation = glm::dvec3(matrix[3]);
    glm::dmat3 turn(matrix);
    for (int axis = 0; axis < 3; ++axis) {
        transform.scale[axis] = glm::length(turn[axis]);
        if (!(transform.scale[axis] > 0)) return std::nullopt;
        turn[axis] /= transform.scale[axis];
    }
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(glm::dot(turn[axis], turn[(axis + 1) % 3])) > kSheared) return std::nullopt;
    if (glm::determinant(turn) < 0) {
        transform.scale.x = -transform.scale.x;
        turn[0] = -turn[0];
    }
    transform.rotation = glm::normalize(glm::quat_cast(turn));
    return transform;
}

// Values that hardly changed are kept as they were, so that numbers that somebody typed stay.
LocalTransform dragged_to(const LocalTransform& before, const glm::dmat4& matrix) {
    constexpr double kSame = 1e-9;
    const std::optional<LocalTransform> parts = before.has_matrix ? std::nullopt : decomposed(matrix);
    if (!parts) {
        LocalTransform transform = before;
        transform.has_matrix = true;
        transform.matrix = matrix;
        return transform;
    }
    LocalTransform transform = *parts;
    if (glm::distance(transform.translation, before.translation) < kSame) transform.translation = before.translation;
    if (glm::distance(transform.scale, before.scale) < kSame) transform.scale = before.scale;
    if (1 - std::abs(glm::dot(transform.rotation, before.rotation)) < kSame * kSame)
        transform.rotation = before.rotation;
    return transform;
}

LocalTransform placed(LocalTransform transform, const Placement& placement) {
    if (placement.to) transform = dragged_to(transform, *placement.to);
    if (placement.matrix) {
        transform.has_matrix = true;
        transform.matrix = *placement.matrix;
    }
    glm::dvec3 at = position_of(transform);
    if (placement.at) at = *placement.at;
    if (placement.move) at += *placement.move;
    glm::dquat turn(1, 0, 0, 0);
    const glm::dvec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int axis = 0; axis < 3 && placement.turn_deg; ++axis)
        turn = glm::angleAxis(glm::radians((*placement.turn_deg)[axis]), axes[axis]) * turn;
    const glm::dvec3 scale = placement.scale.value_or(glm::dvec3(1));
    if (transform.has_matrix) {
        if (placement.turn_deg) transform.matrix = glm::mat4_cast(turn) * transform.matrix;
        for (int axis = 0; axis < 3; ++axis) transform.matrix[axis] *= scale[axis];
        transform.matrix[3] = glm::dvec4(at, 1);
    } else {
        transform.translation = at;
        if (placement.turn_deg) transform.rotation = turn * transform.rotation;
        transform.scale *= scale;
    }
    return transform;
}

// What changed, as a list of phrases. The position is left out where the node was only turned or scaled by a drag.
std::vector<std::string> changes_of(const Placement& placement, const LocalTransform& before,
                                    const LocalTransform& transform) {
    std::vector<std::string> changes;
    if (placement.to && !transform.has_matrix) {
        if (transform.rotation != before.rotation) changes.emplace_back("turned");
        if (transform.scale != before.scale) changes.push_back("scaled to " + text_of(transform.scale));
        if (!changes.empty() && transform.translation == before.translation) return changes;
    }
    if (placement.matrix) changes.push_back("a matrix of its own");
    if (placement.turn_deg) changes.push_back(fmt::format("turned by {}°", text_of(*placement.turn_deg)));
    if (placement.scale) {
        const glm::dvec3 factors = *placement.scale;
        const bool even = factors == glm::dvec3(factors.x);
        changes.push_back(fmt::format("scaled by {}", even ? fmt::format("{:.6g}", factors.x) : text_of(factors)));
    }
    if (placement.aim) changes.push_back("looks at " + text_of(*placement.aim));
    changes.push_back("at " + text_of(position_of(transform)));
    return changes;
}

void edit_sound(stage::StageFile& file, ordered_json& performer, const PerformerEdit& edit,
                std::vector<std::string>& changes) {
    if (edit.sound && edit.sound->empty()) {
        performer.erase("sound");
        changes.push_back("no sound");
    } else if (edit.sound) {
        performer["sound"]["uri"] = stage::uri_of_file_or_address(file, *edit.sound);
        changes.push_back("sound " + performer["sound"]["uri"].get<std::string>());
    }
    if (!edit.gain_db) return;
    if (!performer.contains("sound"))
        throw InputError(Setting{"gain"}, fmt::format("{}", *edit.gain_db), "the performer has no sound",
                         Remedy::kGiveSound);
    performer["sound"]["gain"] = *edit.gain_db;
    changes.push_back(fmt::format("gain {} dB", *edit.gain_db));
}

void edit_performer(stage::StageFile& file, ordered_json& performer, const PerformerEdit& edit,
                    std::vector<std::string>& changes) {
    const auto set = [&](const char* name, const auto& value, const std::string& text) {
        if (!value) return;
        performer[name] = *value;
        changes.push_back(text);
    };
    if (edit.clip) {
        performer["uri"] = stage::uri_of_file_or_address(file, *edit.clip);
        changes.push_back("plays " + performer["uri"].get<std::string>());
    }
    if (edit.time) {
        if (edit.time->empty())
            performer.erase("time");
        else
            performer["time"] = stage::json_of(*edit.time);
        changes.push_back("time " + (edit.time->empty() ? "as the clip's" : stage::text_of(*edit.time)));
    }
    set("spin", edit.spin_deg_per_s, fmt::format("spins {}° a second", edit.spin_deg_per_s.value_or(0)));
    set("opacity", edit.opacity, fmt::format("opacity {}", edit.opacity.value_or(0)));
    set("visible", edit.visible, edit.visible.value_or(false) ? "is seen" : "is not seen");
    set("castsShadow", edit.casts_shadow, edit.casts_shadow.value_or(false) ? "casts shadows" : "casts no shadows");
    set("receivesShadow", edit.receives_shadow,
        edit.receives_shadow.value_or(false) ? "shadows fall on it" : "no shadows fall on it");
    if (edit.skeleton && edit.skeleton->empty()) {
        performer.erase("skeleton");
        changes.push_back("the skeleton beside its clip");
    } else if (edit.skeleton) {
        performer["skeleton"] = {{"uri", stage::uri_of_file(file, *edit.skeleton)}};
        changes.push_back("skeleton " + performer["skeleton"]["uri"].get<std::string>());
    }
    edit_sound(file, performer, edit, changes);
}

void edit_environment(stage::StageFile& file, ordered_json& stage, const StageEdit& edit,
                      std::vector<std::string>& changes) {
    if (edit.environment && edit.environment->empty()) {
        stage.erase("environment");
        changes.push_back("no environment");
        return;
    }
    if (!edit.environment && !edit.environment_intensity && !edit.environment_rotation_deg) return;
    if (!edit.environment && !stage.contains("environment"))
        throw InputError(file.path.string(), "environment", "there is none to change", "give it an image");
    ordered_json& environment = stage["environment"];
    if (edit.environment) environment["uri"] = stage::uri_of_file(file, *edit.environment);
    if (edit.environment_intensity) environment["intensity"] = *edit.environment_intensity;
    if (edit.environment_rotation_deg) environment["rotation"] = *edit.environment_rotation_deg;
    changes.push_back(fmt::format("environment {}, intensity {:.6g}, turned by {:.6g}°",
                                  environment["uri"].get<std::string>(), environment.value("intensity", 1.0),
                                  environment.value("rotation", 0.0)));
}

std::string edit_stage(stage::StageFile& file, const StageEdit& edit) {
    declare_extension(file, stage::kStageExtension);
    ordered_json& stage = make_extension(file, scene_of(file), stage::kStageExtension);
    std::vector<std::string> changes;
    const auto set = [&](const char* name, const ordered_json& value, const std::string& text) {
        stage[name] = value;
        changes.push_back(text);
    };
    const auto set_color = [&](const char* name, const char* text, const std::optional<glm::dvec3>& color) {
        if (color) set(name, json_of(*color), fmt::format("{} {}", text, text_of(*color)));
    };
    if (edit.duration_s) set("duration", *edit.duration_s, fmt::format("lasts {:.6g} s", *edit.duration_s));
    if (edit.fps) set("fps", *edit.fps, fmt::format("{:.6g} images a second", *edit.fps));
    set_color("background", "background", edit.background);
    set_color("ambient", "ambient light", edit.ambient);
    edit_environment(file, stage, edit, changes);
    if (edit.blend) {
        const char* const name = stage::kStageBlendNames[static_cast<size_t>(*edit.blend)];
        set("blend", name, fmt::format("performers blend: {}", name));
    }
    if (edit.shadows) set("shadows", *edit.shadows, *edit.shadows ? "lights cast shadows" : "no shadows");
    if (edit.falloff)
        set("falloff", *edit.falloff, *edit.falloff ? "lights shine on performers" : "no lights shine on performers");
    return "stage: " + (changes.empty() ? "as it was" : with_commas(changes));
}

}  // namespace

std::string place_node(stage::StageFile& file, uint32_t node, const Placement& placement) {
    ordered_json& json = node_of(file, node);
    const LocalTransform before = local_transform_of(json);
    LocalTransform transform = placed(before, placement);
    if (transform.has_matrix && !json.contains("matrix") && is_animated(file, node))
        throw InputError(file.path.string(), fmt::format("/nodes/{}", node),
                         fmt::format("{} is animated, and cannot have a matrix", title_of(file, node)),
                         "move, turn or scale it");
    if (placement.aim) {
        const glm::dvec3 direction = *placement.aim - position_of(transform);
        if (!(glm::length(direction) > 1e-9))
            throw InputError(file.path.string(), fmt::format("/nodes/{}", node), "it stands where it shall look");
        if (transform.has_matrix) {
            // The axes keep their lengths; shear is lost.
            const glm::dmat4 turn = glm::mat4_cast(rotation_towards(direction));
            for (int axis = 0; axis < 3; ++axis)
                transform.matrix[axis] = glm::length(glm::dvec3(transform.matrix[axis])) * turn[axis];
        } else {
            transform.rotation = rotation_towards(direction);
        }
    }
    set_local_transform(json, transform);
    return fmt::format("{}: {}{}", title_of(file, node), with_commas(changes_of(placement, before, transform)),
                       is_animated(file, node) ? ", but an animation moves it" : "");
}

std::string rename_node(stage::StageFile& file, uint32_t node, const std::string& name) {
    const std::string before = title_of(file, node);
    ordered_json& json = node_of(file, node);
    if (name.empty()) throw InputError(file.path.string(), before, "cannot be named \"\"", "choose a name");
    if (json.contains("name")) json["name"] = "";  // so that its own name is free
    const std::string free = FreeNames(file).take(name);
    json["name"] = free;
    return fmt::format("{}: named \"{}\"{}", before, free,
                       free == name ? "" : fmt::format(", as there is a \"{}\" already", name));
}

std::string add_performer(stage::StageFile& file, const std::string& name, const PerformerEdit& edit,
                          const Placement& placement) {
    if (!edit.clip) throw InputError(file.path.string(), "performer", "has no clip", "give it a .nvv");
    const std::string preferred = name.empty() ? edit.clip->stem().string() : name;
    PerformerEdit with_sound = edit;
    if (!edit.sound) with_sound.sound = voctree::sound_beside(*edit.clip);
    return all_or_nothing(file, [&] {
        const uint32_t node = append_node(file, {{"name", FreeNames(file).take(preferred)}});
        declare_extension(file, stage::kPerformerExtension);
        std::vector<std::string> changes;
        edit_performer(file, make_extension(file, node_of(file, node), stage::kPerformerExtension), with_sound,
                       changes);
        return "added " + place_node(file, node, placement) + ", " + with_commas(changes);
    });
}

std::string set_performer(stage::StageFile& file, uint32_t node, const PerformerEdit& edit) {
    std::vector<std::string> changes;
    edit_performer(file, performer_of(file, node), edit, changes);
    return title_of(file, node) + ": " + (changes.empty() ? "as it was" : with_commas(changes));
}

std::string set_stage(stage::StageFile& file, const StageEdit& edit) {
    return all_or_nothing(file, [&] { return edit_stage(file, edit); });
}

}  // namespace neuvv::edit
