// Painting and projecting images where a hand's ray meets a performer.
#include <fstream>
#include <utility>

#include "edit/select.h"
#include "gpu/device.h"
#include "headset/brush_in_hand.h"
#include "headset/hands_at_a_stage.h"
#include "tools/headset/draw/images.h"
#include "tools/headset/hands/hand_painter.h"

namespace neuvv::test {
namespace {

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

}  // namespace
}  // namespace neuvv::test
