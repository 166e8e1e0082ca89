// A document together with its stage at the present time, on the host: for a program that draws the stage on its own
// thread, without the render thread, and for tests.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "editor/clock.h"
#include "editor/editor.h"
#include "stage/evaluated_stage.h"
#include "voctree/files/solid_leaves.h"

namespace neuvv::editor {

// What is solid of a performer at its time.
struct SolidPart {
    SolidPart() = default;
    SolidPart(std::shared_ptr<const voctree::SolidLeaves> of, double at) : leaves(std::move(of)), frame(at) {}
    std::shared_ptr<const voctree::SolidLeaves> leaves;  // null: not known
    double frame = 0;
    // The box of it, in the performer's space in metres, found when it is first asked for.
    const std::pair<glm::dvec3, glm::dvec3>& box() const {
        if (!box_) box_ = leaves->box_at(frame);
        return *box_;
    }

  private:
    mutable std::optional<std::pair<glm::dvec3, glm::dvec3>> box_;
};

struct StageState {
    Editor editor;
    StageClock clock;
    std::shared_ptr<const stage::Stage> stage;  // made from the document with the id `stage_id`
    uint64_t stage_id = 0;
    // Per clip: the corners, low and high, of the box around its leaves, in the performer's space in metres; the clip's
    // own box is larger. Empty while they are not known.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> leaf_boxes;
    // By performer of `stage`: what is solid at the time of `evaluated`. Whoever draws sets it after evaluate(); empty
    // while it is not known.
    std::vector<SolidPart> solid;
    stage::EvaluatedStage evaluated;  // `stage` at the displayed time, with dragged nodes where the drag has moved them

    // Makes the stage from the document where that was edited since; an edit that cannot be drawn is taken back. Throws
    // InputError only for the first document.
    void follow_document();
    // Computes `evaluated` for the displayed time.
    void evaluate();
    // Whether the document was edited since the stage was made: then indices of the stage may mean other nodes in the
    // document.
    bool is_behind() const { return stage_id != editor.id(); }
    // The performer on the selected node, an index into stage->performers; nullopt where there is none.
    std::optional<uint32_t> selected_performer() const;
};

// The corners of the box around what is solid of a performer at its time, without floaters, in its own space. Where
// that is not known, the box around its clip's leaves; where that is not known either, the clip's box.
std::pair<glm::dvec3, glm::dvec3> box_of(const StageState& state, uint32_t performer);

// Whether the stage has a set: anything but performers that is drawn.
bool has_set(const stage::Stage& stage);
// The height of the floor in the world, metres: 0 where there is a set, else the bottom of the lowest performer's box.
double floor_of(const StageState& state);

// Moves a node in the world, together with all nodes below it and the performers, lights and cameras on them.
void move_node(stage::EvaluatedStage& evaluated, const stage::Stage& stage, uint32_t node,
               const glm::dmat4& world_from_node);

}  // namespace neuvv::editor
