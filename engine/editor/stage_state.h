// A document together with the stage that it means at the present time, on the host: for a face that shows a stage
// without the render thread, and for tests.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "editor/clock.h"
#include "editor/editor.h"
#include "stage/evaluated_stage.h"

namespace neuvv::editor {

struct StageState {
    Editor editor;
    StageClock clock;
    std::shared_ptr<const stage::Stage> stage;  // of the document with id `stage_id`
    uint64_t stage_id = 0;
    // By clip: the box around its leaves, low and high, in the performer's space; a clip's own box is wider. Empty
    // while it is not known.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> leaf_boxes;
    stage::EvaluatedStage evaluated;  // of `stage`, with dragged nodes where the drag has them

    // Makes the stage from the document where it was edited since; a document that cannot be shown is taken back.
    // Throws InputError only for the first one.
    void follow_document();
    void evaluate();
    // The document was edited since: numbers of `stage` may mean other things there.
    bool is_behind() const { return stage_id != editor.id(); }
    // The performer on the selected node, an index into stage->performers.
    std::optional<uint32_t> selected_performer() const;
};

// The box of a performer, in its own space: around its leaves, where they are known.
std::pair<glm::dvec3, glm::dvec3> box_of(const StageState& state, uint32_t performer);

// Whether anything but performers is drawn.
bool has_set(const stage::Stage& stage);
// The height that users and performers stand at, in the world: 0 where there is a set, else the bottom of the lowest
// performer's box.
double floor_of(const StageState& state);

// Moves a node in the world; everything that hangs on it goes along: performers, meshes, lights.
void move_node(stage::EvaluatedStage& evaluated, const stage::Stage& stage, uint32_t node,
               const glm::dmat4& world_from_node);

}  // namespace neuvv::editor
