// Two hands and a stage of two performers, without a headset: what a frame of the program does between the runtime's
// poses and the images.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "edit/operations.h"
#include "support/figure.h"
#include "support/temporary_folder.h"
#include "tools/headset/hands/interaction.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {

// The centres of anna and ben, who are 1.6 m high and stand 2 m before the user; and the hands' first positions.
constexpr glm::dvec3 kAnna(-0.8, 0.8, -2), kBen(0.8, 0.8, -2), kRightHand(0.2, 1.2, -0.3), kLeftHand(-0.2, 1.2, -0.3);

inline xr::Pose pointing(glm::dvec3 from, glm::dvec3 to) {
    return {from, glm::quatLookAt(glm::normalize(to - from), glm::dvec3(0, 1, 0))};
}

class HandsAtAStage : public testing::Test {
  protected:
    HandsAtAStage() : jobs([this](const std::string& problem) { state.editor.notify(problem, true); }, [] {}) {
        voctree::write_nvv(clip, figure_tree());
        stage::StageFile file = edit::new_stage(folder.path / "stage.gltf");
        for (const auto& [name, centre] : {std::pair{"anna", kAnna}, std::pair{"ben", kBen}}) {
            edit::PerformerEdit performer;
            performer.clip = clip;
            edit::Placement placement;
            placement.matrix =
                glm::dmat4(1.6, 0, 0, 0, 0, 1.6, 0, 0, 0, 0, 1.6, 0, centre.x - 0.8, 0, centre.z - 0.8, 1);
            edit::add_performer(file, name, performer, placement);
        }
        state.editor.open({std::move(file), {}, {}}, false);
        point(xr::kRight, kRightHand, kBen);
        point(xr::kLeft, kLeftHand, kAnna);
        frame();
    }
    ~HandsAtAStage() override { jobs.stop(); }

    void point(int hand, glm::dvec3 from, glm::dvec3 to) { inputs[hand].aim = inputs[hand].grip = pointing(from, to); }
    // Runs a frame. Buttons that were pressed are released after it.
    void frame(double dt_s = 1.0 / 90) {
        jobs.run_posted();
        state.follow_document();
        state.evaluate();
        if (state.new_performer) state.new_performer->is_read |= clips_are_read;
        interaction.update(state, inputs, head, dt_s, find_surfaces);
        for (xr::HandInput& input : inputs) input.menu = input.play = input.undo = input.duplicate = false;
    }
    void frames(int count) {
        for (int i = 0; i < count; ++i) frame();
    }
    // Runs frames until all jobs and strokes have ended.
    void settle() {
        const auto from = std::chrono::steady_clock::now();
        do {
            frame();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            ASSERT_LT(std::chrono::steady_clock::now() - from, std::chrono::seconds(60))
                << "it does not come to an end";
        } while (!jobs.idle() || jobs.has_posted() || interaction.painter.is_busy() || state.is_behind());
    }
    void select(glm::dvec3 target) {
        point(xr::kRight, kRightHand, target);
        inputs[xr::kRight].select = 1;
        frame();
        inputs[xr::kRight].select = 0;
        frame();
    }

    uint32_t node(const std::string& name) const { return edit::find_node(state.editor.file(), name); }
    glm::dvec3 position(const std::string& name) const { return {state.evaluated.pose.world_from_node[node(name)][3]}; }
    size_t undo_all() {  // returns the number of steps
        size_t count = 0;
        for (; state.editor.history().next_undo(); ++count) state.editor.undo();
        return count;
    }
    bool was_notified(const std::string& part) {
        bool found = false;
        for (const editor::Notice& notice : state.editor.take_notices())
            found |= notice.text.find(part) != std::string::npos;
        return found;
    }

    TemporaryFolder folder;
    std::filesystem::path clip = folder.path / "figure.nvv";
    xr::HandInputs inputs;
    bool clips_are_read = true;           // those of new performers, at once
    headset::FindSurfaces find_surfaces;  // of the rays; empty: none is known
    xr::Pose head{{0, 1.5, 0}, {1, 0, 0, 0}};
    headset::HeadsetState state;
    JobQueue jobs;
    headset::Interaction interaction = headset::Interaction(jobs);
};

}  // namespace neuvv::test
