// What the panel does with performers beside copying and deleting them: life size, hiding, names, new ones.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/headset/state/headset_state.h"

namespace neuvv::headset {

constexpr double kNewPerformer_m = 2;

// Edits the document: the selected performer gets the scale that its clip was recorded in, 1 along each axis, in the
// world. The centre between its feet, at the bottom of what is solid of it, stays where it is.
void give_life_size(HeadsetState& state);

// Edits the document: the selected performer comes to stand on the floor kNewPerformer_m before the user whose head is
// at `head` (tracking space), and faces the user; beside others who stand there.
void bring_here(HeadsetState& state, const xr::Pose& head);
// Edits the document: all performers that are seen come to stand before the user, in the same order, and become smaller
// together where they take more room than `room_m` (width, depth) of the floor, or are higher than kRoomHeight_m.
void fit_to_room(HeadsetState& state, const xr::Pose& head, glm::dvec2 room_m);
constexpr double kRoomHeight_m = 2.4;

// Edits the document: hides the selected performer, which is then no longer selected.
void hide_selected(HeadsetState& state);
// The performers that are hidden, by themselves or by a node above them: indices into Stage::performers.
std::vector<uint32_t> hidden_performers(const HeadsetState& state);
// Edits the document: shows a performer, and hidden nodes above it, and selects it.
void show_performer(HeadsetState& state, uint32_t performer);

// Edits the document: renames the selected performer. An empty name changes nothing.
void rename_selected(HeadsetState& state, const std::string& name);

// The clips that may be added: those of the document's performers, then those in the folder of the stage's file; each
// once, at most kMaxClips.
constexpr size_t kMaxClips = 24;
std::vector<std::filesystem::path> clips_at_hand(const editor::Editor& editor);
// Begins to add a performer of a clip, kNewPerformer_m before the user whose head is at `head` (tracking space), and
// turned to the user. While its clip is being read (NewPerformer::is_read), the stage stays as it is; a performer that
// is chosen meanwhile takes its place.
void add_performer(HeadsetState& state, const std::filesystem::path& clip, const xr::Pose& head);
// To be called in each frame. Edits the document: adds the new performer once its clip has been read, and selects it;
// once the clip is on the stage, so that its feet are known, puts them on the floor, beside others who stand there.
// Both are one step of the history. Nothing begins while `is_busy`, because hands do something that another edit would
// end.
void land_new_performer(HeadsetState& state, bool is_busy);

// "show.gltf" becomes "show-2.gltf", "show-2.gltf" becomes "show-3.gltf": the first of these names that no file has.
std::filesystem::path next_numbered(const std::filesystem::path& path);

}  // namespace neuvv::headset
