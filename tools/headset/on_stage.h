// The stage that is watched and edited in a headset, on the host: document, time, where its user stands, what is
// chosen. No OpenXR and no device here: what hands do to it is the same in a test.
#pragma once

#include <memory>
#include <optional>

#include "stage/stage_instant.h"
#include "tools/viewer/editor.h"
#include "tools/viewer/playback.h"
#include "xr/locomotion.h"

namespace neuvv::headset {

enum class HandTool { kArrange, kPaint, kRegion };

struct Comfort {
    bool smooth_walk = false;  // else teleports
    bool smooth_turn = false;  // else snaps
    double snap_deg = 30, turn_deg_per_s = 90, walk_m_per_s = 1.6;
    bool vignette = true;
};

constexpr double kLeastBrush_m = 0.01, kLargestBrush_m = 0.4, kLeastBrushOpacity = 0.05;
struct HandBrush {
    enum class Tip { kBall, kBox } tip = Tip::kBall;
    enum class Does { kPaint, kErase } does = Does::kPaint;
    double radius_m = 0.06;               // world; half of a box's edge
    glm::vec3 colour{0.9f, 0.25f, 0.1f};  // sRGB, as wheels show it
    double opacity = 1;
    bool whole_clip = true;  // else as it is at this instant, while the surface stays
};

struct OnStage {
    viewer::Editor editor;
    viewer::StageClock clock;
    std::shared_ptr<const stage::Stage> stage;  // of the document with id `stage_id`
    uint64_t stage_id = 0;
    // By clip: around its leaves, low and high, performer's space; a clip's own box is wider. None while not known.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> leaf_boxes;
    stage::StageInstant instant;  // of `stage`, with what a hand holds where it holds it
    xr::XrRig rig;
    double floor_m = 0;  // world: where the user and performers stand
    HandTool tool = HandTool::kArrange;
    Comfort comfort;
    HandBrush brush;
    bool panel_shown = false, panel_on_wrist = false;

    // The document as a stage, where it was edited since; what cannot be shown is taken back. Throws InputError only
    // for the first one.
    void follow_document();
    void look_at_instant();
    // The document was edited since: numbers of `stage` may mean other things there.
    bool is_behind() const { return stage_id != editor.id(); }
    // The performer on the selected node, of stage->performers.
    std::optional<uint32_t> selected_performer() const;
};

// The box of a performer, in its own space: around its leaves, where they are known.
std::pair<glm::dvec3, glm::dvec3> box_of(const OnStage& on, uint32_t performer);

// Where a user first stands: where the stage's first camera does, but upright on the floor; without one, in front of
// its performers. `head` in the tracking space.
xr::XrRig first_rig(const OnStage& on, const xr::Pose& head);
// Whether anything but performers is drawn.
bool has_set(const stage::Stage& stage);
// A set stands at 0; performers alone stand on the lowest of their boxes.
double floor_of(const OnStage& on);

// All that hangs on a node goes along with it: performers, meshes, lights. Where the node was moved to, in the world.
void carry(stage::StageInstant& instant, const stage::Stage& stage, uint32_t node, const glm::dmat4& world_from_node);

}  // namespace neuvv::headset
