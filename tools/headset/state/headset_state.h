// The stage that is watched and edited in a headset, on the host, and its user: position, tool and settings. It needs
// neither OpenXR nor a device, so hands change it in a test as they do in the program.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "edit/operations.h"
#include "editor/stage_state.h"
#include "xr/hands.h"
#include "xr/locomotion.h"

namespace neuvv::headset {

enum class HandTool { kArrange, kPaint, kRegion, kLights, kCoach };
inline bool paints(HandTool tool) {
    return tool == HandTool::kPaint || tool == HandTool::kRegion;
}

// What the panel shows while the tool is kArrange.
enum class PanelPage { kPerformer, kTime, kCopies, kStage, kUser };

// What stands on the panel in place of the tool's rows.
enum class PanelDialogue { kNone, kKeyboard, kClips, kFiles };

// A performer that is being added. It is no part of the document before its clip has been read, and its feet are not
// known before its clip is on the stage.
struct NewPerformer {
    std::filesystem::path clip;
    glm::dmat4 world_from_node{1};
    bool is_read = false;   // the clip can be put on the stage without waiting; whoever draws the stage sets it
    bool is_shown = false;  // the document has the performer, as the preview of an edit (Editor::drag)
};

// What is being opened in place of the document.
struct NextDocument {
    std::filesystem::path path;              // or an address
    std::optional<edit::Document> document;  // once it has been read
    size_t clips_read = 0, clips = 0;        // 0 clips: it is not known yet how many there are
    bool is_read = false;                    // the clips, too; whoever draws the stage sets it
};

struct Comfort {
    bool smooth_walk = false;  // else the user teleports
    bool smooth_turn = false;  // else the user turns in steps of snap_deg
    double snap_deg = 30, turn_deg_per_s = 90, walk_m_per_s = 1.6;
    bool vignette = true;  // dark edges of the image while the user moves smoothly
    // How far the user's floor is raised above the stage's, so that who sits sees what somebody sees who stands. Not
    // while the user's own room is shown, whose floor is where it is.
    double raised_m = 0;
};
constexpr double kLowest_m = -0.5, kHighest_m = 1;  // of Comfort::raised_m
// Comfort::raised_m with which this head (tracking space) is as high as that of somebody who stands.
inline double raised_to_stand(const xr::Pose& head) {
    constexpr double kEyes_m = 1.6, kSeated_m = 0.4;
    const double missing_m = kEyes_m - head.position.y;
    return missing_m > 0 ? std::min(missing_m, kHighest_m) : kSeated_m;
}
constexpr double kMostVolume_percent = 200;

constexpr double kMinBrush_m = 0.01, kMaxBrush_m = 0.4, kMinBrushOpacity = 0.05;
struct HandBrush {
    enum class Tip { kBall, kBox } tip = Tip::kBall;
    enum class Mode { kPaint, kErase, kImage } mode = Mode::kPaint;  // kImage: each press projects an image
    double radius_m = 0.06;               // world; of a box, half the length of an edge; of an image, half its width
    glm::vec3 colour{0.9f, 0.25f, 0.1f};  // sRGB
    double opacity = 1;
    bool by_ray = false;  // paints where the hand's ray meets the performer, else at the hand's tip
    bool uses_ray() const { return by_ray || mode == Mode::kImage; }
    bool whole_clip = true;  // else around the present frame, while the surface stays (edit::Follow::kRun)
};

struct HeadsetState : editor::StageState {
    xr::XrRig rig;
    glm::dvec3 head{0};  // world: where the user's head is in this frame
    // The heading that is straight ahead: that with which the user began, turned by each turn since.
    double ahead_rad = 0;
    double floor_m = 0;               // height in the world: where user and performers stand
    double raised_m = 0;              // Comfort::raised_m as `rig` has it
    std::optional<uint32_t> trainer;  // the performer who coaches the user, while the stage has it
    HandTool tool = HandTool::kArrange;
    PanelPage page = PanelPage::kPerformer;
    edit::CopySettings copies{.count = 3};  // that the panel would make of the selected performer
    PanelDialogue dialogue = PanelDialogue::kNone;
    std::string typed;                         // on the keyboard
    uint32_t typed_for = 0;                    // the node that the keyboard renames
    std::vector<std::filesystem::path> clips;  // that PanelDialogue::kClips offers
    std::optional<NewPerformer> new_performer;
    std::filesystem::path folder;  // that PanelDialogue::kFiles lists
    bool types_address = false;    // the keyboard is for the address of a stream, and renames nobody
    std::optional<NextDocument> next_document;
    Comfort comfort;
    HandBrush brush;
    // Whether to show the user's own room; nothing: as the headset's runtime prefers.
    std::optional<bool> wants_room;
    bool refused_room = false;    // the headset cannot show it, and the user was told so
    bool shows_room = false;      // the room is shown, in place of the set
    std::filesystem::path image;  // that the brush projects; empty: none has been chosen
    bool picks_colour = false;    // the next press of the painting hand gives the brush the colour under its ray
    bool panel_visible = false, panel_on_wrist = false;
    bool slider_edits = false;  // a slider of the panel is dragged, and edits the document (Editor::drag)
    // Ends the drag of a slider: its edit is made.
    void release_slider() {
        if (std::exchange(slider_edits, false)) editor.end_drag();
    }
    bool left_handed = false;  // the hands have each other's roles
    bool hints = true;         // labels at the controllers say what their buttons do
    bool shows_frame_times = false;
    double volume_percent = 100;
    // The hand that has the role of this hand, and the other way round.
    int hand_of(int role) const { return left_handed ? xr::kHands - 1 - role : role; }
    // The frame of its clip that a performer of the stage shows.
    float frame_of(uint32_t performer) const {
        for (const stage::EvaluatedPerformer& at : evaluated.performers)
            if (at.performer == performer) return at.frame;
        return 0;
    }
};

}  // namespace neuvv::headset
