// Painting in the air: which leaves a stroke touches, and that no stroke is lost or stuck, whatever hands and files do.
#include "tools/headset/hands/hand_painter.h"

#include <fstream>
#include <set>
#include <utility>

#include "edit/paint_layers.h"
#include "edit/select.h"
#include "gpu/device.h"
#include "headset/hands_at_a_stage.h"
#include "support/segmented_copy.h"
#include "tools/headset/draw/images.h"

namespace neuvv::test {
namespace {

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

TEST_F(BrushHandTest, ADabPaintsTheLeavesInItsBallAndIsOneStep) {
    dab(head_of_ben);
    settle();
    const std::set<uint32_t> want = within({head_of_ben}, state.brush.radius_m);
    ASSERT_GT(want.size(), 10u);
    EXPECT_EQ(painted(), want);
    EXPECT_EQ(undo_all(), 1u);
    EXPECT_FALSE(state.editor.modified());
}

// A ray that meets ben's surface at a point of the world, or none.
struct RayBrushTest : BrushHandTest {
    std::optional<glm::dvec3> meets;
    uint32_t met = 1;  // ben, as index of performers
    glm::vec3 colour{0.25f, 0.5f, 0.04f};
    RayBrushTest() {
        inputs[xr::kLeft].aim.reset();
        inputs[xr::kLeft].grip.reset();
        state.brush.by_ray = true;
        find_surfaces = [this](std::span<const Ray> rays) {
            std::vector<std::optional<headset::SurfaceHit>> hits(rays.size());
            if (meets) hits.at(0) = headset::SurfaceHit{met, glm::distance(rays[0].origin, *meets), colour};
            return hits;
        };
    }
    void ray_to(std::optional<glm::dvec3> target) {
        meets = target;
        if (target) point(xr::kRight, kRightHand, *target);
        frame();
    }
    void press(bool down) {
        inputs[xr::kRight].select = down ? 1 : 0;
        frame();
    }
};

TEST_F(RayBrushTest, ItPaintsWhereTheRayMeetsThePerformer) {
    ray_to(head_of_ben);
    press(true);
    ray_to(head_of_ben + glm::dvec3(0.02, 0, 0));  // hardly moves
    press(false);
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m)) << "and not at the hand's tip, which is far away";
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(RayBrushTest, WhatARayJumpsOverStaysAsItIs) {
    ray_to(head_of_ben);
    press(true);
    ray_to(head_of_ben + off + off);
    ray_to({});
    ray_to(head_of_ben - off);
    press(false);
    settle();
    EXPECT_EQ(painted(), within({head_of_ben, head_of_ben + off + off, head_of_ben - off}, state.brush.radius_m));
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(RayBrushTest, OthersThanTheSelectedPerformerAreNotPainted) {
    met = 0;
    ray_to(head_of_ben);
    press(true);
    press(false);
    settle();
    EXPECT_EQ(undo_all(), 0u);
}

TEST_F(RayBrushTest, TheColourUnderTheRayIsPickedByTheNextPressAlone) {
    const glm::vec3 before = state.brush.colour;
    state.picks_colour = true;
    meets.reset();
    frame();
    press(true);
    press(false);
    EXPECT_EQ(state.brush.colour, before);
    EXPECT_TRUE(was_notified("point at a performer")) << "and it goes on picking";
    met = 0;  // whoever it is
    ray_to(head_of_ben);
    press(true);
    press(false);
    settle();
    EXPECT_FALSE(state.picks_colour);
    EXPECT_LT(glm::distance(state.brush.colour, glm::vec3(0.5371f, 0.7354f, 0.2210f)), 2e-3) << "sRGB";
    EXPECT_EQ(undo_all(), 0u) << "picking paints nothing";
    met = 1;
    press(true);
    press(false);
    settle();
    EXPECT_EQ(undo_all(), 1u) << "the press after it paints";
}

// Images, with a device that notes what it is asked to project and selects a ball of leaves instead.
struct ImageTest : RayBrushTest {
    std::vector<editor::PaintArea> projected;
    ImageTest() {
        state.brush.mode = headset::HandBrush::Mode::kImage;
        state.brush.by_ray = false;  // an image is put by the ray all the same
        interaction.painter.project_image = [this](const std::filesystem::path& file, editor::PaintSubject subject,
                                                   editor::Layer before, const editor::PaintOperation& operation,
                                                   editor::PaintArea area) {
            EXPECT_EQ(file, clip);
            projected.push_back(std::move(area));
            editor::PaintSession session(std::move(subject), std::move(before), operation);
            session.add_region(edit::sphere_region(glm::vec3(kHead), 0.1f));
            return std::optional(std::move(session));
        };
    }
    void choose() {
        media::write_png(folder.path / "flag.png", media::Image(40, 20));
        state.image = folder.path / "flag.png";
        settle();
    }
    void press_at(std::optional<glm::dvec3> target) {
        ray_to(target);
        press(true);
        press(false);
        settle();
    }
    // The pixel of the projected image in which a point of the world lies.
    glm::dvec2 pixel_of(const editor::PaintArea& area, glm::dvec3 world) const {
        const glm::dmat4 camera_from_world = glm::inverse(area.image_camera.world_from_camera) *
                                             glm::inverse(state.evaluated.performers[1].world_from_performer);
        const glm::dvec3 seen(camera_from_world * glm::dvec4(world, 1));
        const stage::Camera& camera = area.image_camera;
        return {camera.cx - camera.fx * seen.x / seen.z, camera.cy + camera.fy * seen.y / seen.z};
    }
};

TEST_F(ImageTest, APressProjectsTheImageWhereTheRayMeets) {
    choose();
    press_at(head_of_ben);
    ASSERT_EQ(projected.size(), 1u);
    EXPECT_EQ(projected[0].image.width, 40u);
    const glm::dvec3 right = interaction.hands[xr::kRight].aim->rotation * glm::dvec3(1, 0, 0),
                     up = interaction.hands[xr::kRight].aim->rotation * glm::dvec3(0, 1, 0);
    EXPECT_LT(glm::distance(pixel_of(projected[0], head_of_ben), glm::dvec2(20, 10)), 1e-3);
    EXPECT_LT(glm::distance(pixel_of(projected[0], head_of_ben + state.brush.radius_m * right), glm::dvec2(40, 10)),
              1e-3)
        << "it is two radii wide";
    EXPECT_LT(pixel_of(projected[0], head_of_ben + 0.01 * up).y, 10) << "its upper edge is that of the hand";
    EXPECT_FALSE(painted().empty());
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(ImageTest, WhereItCannotBePutANoticeSaysWhy) {
    press_at(head_of_ben);
    EXPECT_TRUE(was_notified("choose an image"));
    choose();
    press_at({});
    EXPECT_TRUE(was_notified("point at the performer"));
    met = 0;
    press_at(head_of_ben);
    EXPECT_TRUE(was_notified("point at the performer")) << "another one than the selected";
    met = 1;
    interaction.painter.project_image = {};
    press_at(head_of_ben);
    EXPECT_TRUE(was_notified("not on the device"));
    state.image = folder.path / "none.png";
    settle();
    EXPECT_TRUE(was_notified("none.png"));
    press_at(head_of_ben);
    EXPECT_TRUE(was_notified("none.png")) << "each press tries again";
    media::write_png(folder.path / "none.png", media::Image(40, 20));
    press_at(head_of_ben);
    EXPECT_FALSE(was_notified("none.png")) << "it is there now";
    EXPECT_TRUE(projected.empty());
    EXPECT_EQ(undo_all(), 0u);
}

// As where the program makes the device anew.
TEST_F(ImageTest, AnImageOutlivesALostDevice) {
    choose();
    const headset::ProjectImage working =
        std::exchange(interaction.painter.project_image, [](auto&&...) -> std::optional<editor::PaintSession> {
            throw gpu::VulkanError(VK_ERROR_DEVICE_LOST, "the device is lost");
        });
    ray_to(head_of_ben);
    EXPECT_THROW((press(true), settle()), gpu::VulkanError);
    interaction.painter.project_image = working;
    press(false);
    settle();
    EXPECT_EQ(projected.size(), 1u);
    EXPECT_EQ(undo_all(), 1u);
    interaction.painter.project_image = [](auto&&...) -> std::optional<editor::PaintSession> {
        throw gpu::VulkanError(VK_ERROR_OUT_OF_DEVICE_MEMORY, "no memory");
    };
    press_at(head_of_ben);
    EXPECT_TRUE(was_notified("no memory"));
}

TEST_F(ImageTest, TheNextImageOfTheFolderFollows) {
    const auto next = [&](const char* after) { return headset::next_image(folder.path, folder.path / after); };
    EXPECT_TRUE(next("").empty());
    for (const char* name : {"b.png", "a.png", "c.txt"}) std::ofstream(folder.path / name) << "";
    EXPECT_EQ(headset::next_image(folder.path, {}).filename(), "a.png");
    EXPECT_EQ(next("a.png").filename(), "b.png");
    EXPECT_EQ(next("b.png").filename(), "a.png") << "after the last one the first";
    EXPECT_TRUE(headset::next_image(folder.path / "nowhere", {}).empty());
}

TEST_F(BrushHandTest, ADabThatIsOverBeforeTheClipWasReadIsLaidAllTheSame) {
    // The whole press is over before the clip has been read.
    dab(head_of_ben);
    EXPECT_TRUE(interaction.painter.is_busy());
    EXPECT_TRUE(state.editor.document().paint.empty());
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
}

TEST_F(BrushHandTest, StrokesThatFollowEachOtherAreEachAStep) {
    dab(head_of_ben);
    dab(head_of_ben + off);
    dab(head_of_ben - off);
    settle();
    EXPECT_EQ(painted(), within({head_of_ben, head_of_ben + off, head_of_ben - off}, state.brush.radius_m));
    state.editor.undo();
    EXPECT_EQ(painted(), within({head_of_ben, head_of_ben + off}, state.brush.radius_m));
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(BrushHandTest, WhatWasUndoneDoesNotComeBackWithTheNextStroke) {
    dab(head_of_ben);
    settle();
    state.editor.undo();
    EXPECT_FALSE(state.editor.modified());
    dab(head_of_ben + off);
    settle();
    const auto layers = edit::paint_layers_of(state.editor.file(), node("ben"));
    ASSERT_EQ(layers->size(), 1u);
    std::set<uint32_t> leaves;
    for (const voctree::LeafEdit& edit : state.editor.document().paint.at(layers->front().path)->edits)
        leaves.insert(edit.leaf);
    EXPECT_EQ(leaves, within({head_of_ben + off}, state.brush.radius_m));
}

TEST_F(BrushHandTest, AHandThatHoldsPutsDownWhereTheOtherTakesTheBrush) {
    state.tool = headset::HandTool::kArrange;
    const glm::dvec3 before = position("ben");
    point(xr::kLeft, kLeftHand, kBen);
    inputs[xr::kLeft].grab = 1;
    frames(2);
    point(xr::kLeft, kLeftHand + glm::dvec3(0.3, 0, 0), kBen + glm::dvec3(0.3, 0, 0));
    frame();
    state.tool = headset::HandTool::kPaint;  // as the panel does it
    frames(2);
    EXPECT_FALSE(interaction.grab.is_active());
    dab(head_of_ben + glm::dvec3(0.3, 0, 0));
    inputs[xr::kLeft].grab = 0;
    settle();
    EXPECT_LT(glm::distance(position("ben"), before + glm::dvec3(0.3, 0, 0)), 1e-9);
    EXPECT_EQ(undo_all(), 2u) << "a move and a stroke";
}

TEST_F(BrushHandTest, APressInTheFrameOfAnEditIsAStroke) {
    settle();
    tip_at(head_of_ben);
    inputs[xr::kRight].select = 1;
    inputs[xr::kLeft].undo = true;
    state.editor.edit(
        [&](edit::Document& document) { return edit::rename_node(document.file, node("anna"), "berta"); });
    frame();
    inputs[xr::kRight].select = 0;
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
    EXPECT_EQ(state.stage->performers[0].name, "anna") << "it was undone";
}

TEST_F(BrushHandTest, AStrokeCoversItsWayHoweverFewFramesItHas) {
    tip_at(head_of_ben - glm::dvec3(0.3, 0, 0));
    inputs[xr::kRight].select = 1;
    frame();
    tip_at(head_of_ben + glm::dvec3(0.3, 0, 0));
    frame();
    inputs[xr::kRight].select = 0;
    settle();
    std::vector<glm::dvec3> path;
    for (int i = 0; i <= 600; ++i) path.push_back(head_of_ben + glm::dvec3(-0.3 + 0.001 * i, 0, 0));
    EXPECT_EQ(painted(), within(path, state.brush.radius_m));
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(BrushHandTest, UndoDuringAStrokeEndsItAndIsRefusedUntilItIsLaid) {
    tip_at(head_of_ben);
    inputs[xr::kRight].select = 1;
    frame();
    inputs[xr::kLeft].undo = true;
    frame();
    EXPECT_TRUE(was_notified("still being laid"));
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
    inputs[xr::kLeft].undo = true;
    frame();
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(BrushHandTest, AStrokeBelongsToThePerformerItWasBegunOn) {
    dab(head_of_ben);
    state.tool = headset::HandTool::kArrange;
    select(kAnna);
    state.tool = headset::HandTool::kPaint;
    settle();
    ASSERT_EQ(state.editor.document().paint.size(), 1u);
    const auto layers = edit::paint_layers_of(state.editor.file(), node("ben"));
    ASSERT_TRUE(layers);
    EXPECT_EQ(layers->size(), 1u);
    EXPECT_TRUE(edit::paint_layers_of(state.editor.file(), node("anna"))->empty());
}

TEST_F(BrushHandTest, AClipThatCannotBeReadIsReportedAndNothingIsStuck) {
    damage(clip);
    dab(head_of_ben);
    settle();
    EXPECT_TRUE(was_notified("figure.nvv"));
    EXPECT_FALSE(interaction.painter.is_busy());
    EXPECT_NE(interaction.painter.status().find("figure.nvv"), std::string::npos) << "as long as it is to be painted";
    EXPECT_FALSE(state.editor.modified());
    inputs[xr::kRight].duplicate = true;
    frames(2);
    EXPECT_EQ(state.stage->performers.size(), 3u) << "other edits go on";
}

TEST_F(BrushHandTest, AnotherPerformerIsPaintedAllTheSame) {
    const std::filesystem::path copy = folder.path / "copy.nvv";
    std::filesystem::copy_file(clip, copy);
    edit::PerformerEdit edit;
    edit.clip = copy;
    state.editor.edit([&](edit::Document& document) { return edit::set_performer(document.file, node("anna"), edit); });
    state.tool = headset::HandTool::kArrange;  // so that ben's clip is not read yet
    frames(2);
    damage(copy);
    select(kAnna);
    state.tool = headset::HandTool::kPaint;
    dab(kAnna);
    settle();
    EXPECT_TRUE(was_notified("copy.nvv"));
    state.tool = headset::HandTool::kArrange;
    select(kBen);
    state.tool = headset::HandTool::kPaint;
    dab(head_of_ben);
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
}

TEST_F(BrushHandTest, AClipInSegmentsIsPaintedInTheOthersToo) {
    const std::filesystem::path parts = folder.path / "parts.nvv";
    write_segmented_copy(figure_tree(), {1, 1}, parts);
    edit::PerformerEdit edit;
    edit.clip = parts;
    state.editor.edit([&](edit::Document& document) { return edit::set_performer(document.file, node("ben"), edit); });
    state.brush.whole_clip = true;
    frames(2);
    dab(head_of_ben);
    settle();
    const auto layers = edit::paint_layers_of(state.editor.file(), node("ben"));
    ASSERT_EQ(layers->size(), 1u);
    const auto files = voctree::files_of_layer(state.editor.document().paint, layers->front().path);
    ASSERT_EQ(files.size(), 2u);
    const glm::dmat4 performer_from_world = glm::inverse(state.evaluated.performers[1].world_from_performer);
    const glm::vec3 centre(performer_from_world * glm::dvec4(head_of_ben, 1));
    uint32_t number = 0;
    for (const auto& [file, layer] : files) {
        const voctree::VOctree tree = voctree::read_nvv(parts / voctree::segment_file_name(number));
        const edit::Canvas canvas(tree);
        EXPECT_EQ(layer->field, voctree::painted_field(tree));
        std::set<uint32_t> painted, near;
        for (const voctree::LeafEdit& one : layer->edits) painted.insert(one.leaf);
        for (const uint32_t leaf :
             edit::leaves_in(canvas, edit::sphere_region(centre, static_cast<float>(state.brush.radius_m / 1.6)), 0, 0))
            near.insert(leaf);
        ASSERT_GT(painted.size(), 10u) << number;
        // What was not there at the time of the stroke is not painted.
        EXPECT_TRUE(std::includes(near.begin(), near.end(), painted.begin(), painted.end())) << number;
        EXPECT_TRUE(number > 0 || painted == near) << "all of the segment that was seen";
        ++number;
    }
    EXPECT_EQ(undo_all(), 3u) << "another clip, a stroke, and the same in the other segment";
}

TEST_F(BrushHandTest, ErasingTakesDensityAndKeepsToThisFrameWhereItIsAsked) {
    state.brush.mode = headset::HandBrush::Mode::kErase;
    state.brush.whole_clip = false;
    state.clock.scrub(state.clock.last_s());
    dab(head_of_ben);
    settle();
    ASSERT_EQ(state.editor.document().paint.size(), 1u);
    for (const auto& [path, layer] : state.editor.document().paint) {
        ASSERT_FALSE(layer->edits.empty());
        for (const voctree::LeafEdit& edit : layer->edits) {
            EXPECT_EQ(edit.sigma, 0);
            EXPECT_LE(edit.first, 1);
            EXPECT_GE(edit.last, 1);
        }
    }
}

TEST_F(BrushHandTest, ARegionIsColouredAndForgottenWhereNodesChange) {
    state.tool = headset::HandTool::kRegion;
    settle();  // reads the clip
    tip_at(head_of_ben - glm::dvec3(0.1));
    inputs[xr::kRight].select = 1;
    frame();
    tip_at(head_of_ben + glm::dvec3(0.1));
    frame();
    inputs[xr::kRight].select = 0;
    frame();
    ASSERT_TRUE(interaction.painter.region());
    EXPECT_LT(glm::distance(interaction.painter.region()->low, kHead - glm::dvec3(0.1 / 1.6)), 1e-6);
    interaction.painter.apply_region(state);
    settle();
    EXPECT_GT(painted().size(), 10u);
    ASSERT_TRUE(interaction.painter.region()) << "it can be used again";
    inputs[xr::kRight].duplicate = true;
    frames(3);
    EXPECT_FALSE(interaction.painter.region()) << "numbers of nodes mean others now";
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(BrushHandTest, ABoxOfNothingIsTold) {
    state.tool = headset::HandTool::kRegion;
    settle();
    tip_at(glm::dvec3(0.05, 1.55, -2.75));
    inputs[xr::kRight].select = 1;
    frame();
    tip_at(glm::dvec3(0.06, 1.56, -2.74));
    frame();
    inputs[xr::kRight].select = 0;
    frame();
    interaction.painter.apply_region(state);
    settle();
    EXPECT_TRUE(was_notified("nothing in the box"));
    EXPECT_FALSE(state.editor.modified());
    EXPECT_FALSE(interaction.painter.is_busy());
}

TEST_F(BrushHandTest, ItSaysWhatItPaintsOn) {
    settle();
    frame();
    EXPECT_EQ(interaction.painter.status(), "Paints ben, on a new layer");
    dab(head_of_ben);
    settle();
    frame();
    EXPECT_EQ(interaction.painter.status(), "Paints ben, on its layer \"headset\"");
}

TEST_F(BrushHandTest, NobodyIsPaintedWhereItIsNotKnownWho) {
    state.tool = headset::HandTool::kArrange;
    select({0, 5, -2});
    state.tool = headset::HandTool::kPaint;
    dab(head_of_ben);
    EXPECT_FALSE(interaction.painter.is_busy());
    EXPECT_NE(interaction.painter.status().find("Select"), std::string::npos);
}

}  // namespace
}  // namespace neuvv::test
