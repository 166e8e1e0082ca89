// A hand that paints in the air.
#pragma once

#include <fstream>
#include <set>

#include "edit/select.h"
#include "headset/hands_at_a_stage.h"
#include "tools/headset/hands/hand_painter.h"

namespace neuvv::test {

struct BrushHandTest : HandsAtAStage {
    BrushHandTest() {
        select(kBen);
        state.tool = headset::HandTool::kPaint;
        state.brush.radius_m = 0.15;
    }
    // Moves the right hand so that its tip is at this position; the hand points along −Z.
    void tip_at(glm::dvec3 position) {
        inputs[xr::kRight].aim = inputs[xr::kRight].grip = pointing(position, position + glm::dvec3(0, 0, -1));
        inputs[xr::kRight].aim->position += position - headset::HandPainter::tip_of(*inputs[xr::kRight].aim);
    }
    void dab(glm::dvec3 position) {
        tip_at(position);
        inputs[xr::kRight].select = 1;
        frame();
        inputs[xr::kRight].select = 0;
        frame();
    }
    // Damages a file near its end; its beginning stays valid.
    static void damage(const std::filesystem::path& file) {
        std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
        bytes.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file)) - 1000) << std::string(100, 'x');
    }
    // The leaves that are painted on the only layer.
    std::set<uint32_t> painted() const {
        std::set<uint32_t> leaves;
        EXPECT_EQ(state.editor.document().paint.size(), 1u);
        for (const auto& [path, layer] : state.editor.document().paint)
            for (const voctree::LeafEdit& edit : layer->edits) leaves.insert(edit.leaf);
        return leaves;
    }
    // The expected leaves: those that are ever visible, and whose centres lie within `radius_m` (world) of a position.
    std::set<uint32_t> within(const std::vector<glm::dvec3>& positions, double radius_m) const {
        const voctree::VOctree tree = figure_tree();
        const edit::Canvas canvas(tree);
        const glm::dmat4 performer_from_world = glm::inverse(state.evaluated.performers[1].world_from_performer);
        const voctree::EditLayer none{voctree::painted_field(tree), {}};
        std::set<uint32_t> leaves;
        for (const glm::dvec3& position : positions) {
            const glm::vec3 centre(performer_from_world * glm::dvec4(position, 1));
            editor::PaintOperation operation;
            operation.frames = {0, 1, edit::Follow::kNot};
            for (const editor::SelectedLeaf& leaf : editor::leaves_for(
                     canvas, none, edit::sphere_region(centre, static_cast<float>(radius_m / 1.6)), operation))
                leaves.insert(leaf.leaf);
        }
        return leaves;
    }
    const glm::dvec3 head_of_ben = glm::dvec3(0, 0, -2.8) + 1.6 * kHead, off = glm::dvec3(0.25, -0.45, 0);
};

}  // namespace neuvv::test
