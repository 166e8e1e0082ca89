// Painting in pieces, as the viewer does while the hand moves, gives the same as painting at once by edit/.
#include "editor/paint/paint_session.h"

#include <algorithm>

#include "support/figure.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

using Kind = editor::PaintOperation::Kind;

struct PaintSessions : GpuTest {
    std::shared_ptr<const editor::PaintClip> clip = std::make_shared<const editor::PaintClip>(figure_tree());
    std::shared_ptr<const render::Field> field = std::make_shared<const render::Field>(
        render::upload_field(device(), clip->tree, render::WeightPrecision::kHalf));
    std::shared_ptr<const voctree::EditLayer> empty =
        std::make_shared<const voctree::EditLayer>(voctree::EditLayer{clip->field, {}});
    editor::PaintSurface surface{device()};
    stage::Camera camera = figure_camera(160);
    // A line over the head, off the figure, and back over the shoulders.
    std::vector<glm::dvec2> line = {{60, 50}, {75, 60}, {84, 52}, {150, 20}, {156, 90}, {90, 130}, {60, 132}};
    editor::PaintOperation operation{.colour = {0, 0.25f, 1}, .opacity = 0.75f, .frames = {0, 0, edit::Follow::kAll}};

    editor::PaintSubject subject(float frame = 0, std::vector<editor::VisibleLayer> paint = {}) const {
        return {clip, field, frame, std::move(paint)};
    }
    editor::PaintSession session(editor::PaintSubject of, std::shared_ptr<const voctree::EditLayer> before,
                                 float radius_m, float hardness) const {
        editor::PaintArea area;
        area.radius_m = radius_m;
        area.hardness = hardness;
        return {std::move(of), std::move(before), operation, area};
    }
    std::shared_ptr<const voctree::EditLayer> touched(editor::PaintSession& in, const stage::Camera& from,
                                                      std::span<const glm::dvec2> pixels) {
        in.add_touches(surface, from, pixels);
        return in.layer();
    }
    // What edit/ paints in one call.
    voctree::EditLayer painted_at_once(float frame) {
        render::Picker picker(device(), *field);
        picker.show(frame);
        const edit::Brush brush{0.05f, 0.6f, operation.colour, operation.opacity};
        voctree::EditLayer layer = *empty;
        voctree::add_edits(layer, edit::at_frames(clip->canvas,
                                                  edit::stroke(clip->canvas, edit::densities(clip->canvas, frame),
                                                               brush, edit::touches_under(picker, camera, line)),
                                                  operation.frames));
        return layer;
    }
};

TEST_F(PaintSessions, PaintInPiecesWhatTheBrushPaintsAtOnce) {
    for (const float frame : {0.0f, 1.0f}) {
        const voctree::EditLayer want = painted_at_once(frame);
        ASSERT_GT(want.edits.size(), 500u);
        for (const size_t piece : {size_t{1}, size_t{2}, line.size()}) {
            editor::PaintSession stroke = session(subject(frame), empty, 0.05f, 0.6f);
            std::shared_ptr<const voctree::EditLayer> layer;
            size_t before = 0;
            for (size_t i = 0; i < line.size(); i += piece) {
                layer = touched(stroke, camera, std::span(line).subspan(i, std::min(piece, line.size() - i)));
                ASSERT_TRUE(layer);
                EXPECT_GE(layer->edits.size(), before) << "it only grows";
                before = layer->edits.size();
            }
            EXPECT_EQ(layer->edits, want.edits) << piece << " at a time, frame " << frame;
            EXPECT_EQ(voctree::defect_of(*layer), "");
        }
    }
}

TEST_F(PaintSessions, FindNothingBesideThePerformer) {
    editor::PaintSession stroke = session(subject(), empty, 0.05f, 0.6f);
    EXPECT_FALSE(touched(stroke, camera, std::vector<glm::dvec2>{{2, 2}, {20, 2}}));
    EXPECT_TRUE(touched(stroke, camera, std::vector<glm::dvec2>{{75, 60}})) << "until it meets something";
}

TEST_F(PaintSessions, BeginALineAnewFromAnotherCamera) {
    const glm::dvec2 head[] = {{75, 60}}, shoulder[] = {{75, 140}};
    stage::Camera other = camera;
    other.world_from_camera[3].x += 1e-6;
    editor::PaintSession moved = session(subject(), empty, 0.02f, 1), still = session(subject(), empty, 0.02f, 1);
    moved.add_touches(surface, camera, head);
    still.add_touches(surface, camera, head);
    EXPECT_LT(touched(moved, other, shoulder)->edits.size(), touched(still, camera, shoulder)->edits.size());
}

TEST_F(PaintSessions, EraseThroughWhatWasErasedBeforeAndRestoreIt) {
    const glm::dvec2 at[] = {{75, 60}};
    surface.show(subject());
    const auto first = surface.surface_at(camera, at[0]);
    ASSERT_TRUE(first);
    const double depth = glm::distance(*first, glm::dvec3(camera.world_from_camera[3]));
    EXPECT_NEAR(glm::distance(*first, kHead), kHeadRadius, 2.0 / kFigureSide) << "on the head's surface";

    operation.kind = Kind::kErase;
    editor::PaintSession hole_session = session(subject(), empty, 0.1f, 1);
    const auto hole = touched(hole_session, camera, at);
    ASSERT_TRUE(hole);
    const editor::PaintSubject holed = subject(0, {{hole}});
    surface.show(holed);
    const auto second = surface.surface_at(camera, at[0]);
    ASSERT_TRUE(second);
    EXPECT_GT(glm::distance(*second, glm::dvec3(camera.world_from_camera[3])), depth + 0.05) << "seen through the hole";
    editor::PaintSession deeper_session = session(holed, hole, 0.1f, 1);
    const auto deeper = touched(deeper_session, camera, at);
    EXPECT_GT(deeper->edits.size(), hole->edits.size());

    operation.kind = Kind::kRestore;
    editor::PaintSession filled_session = session(subject(), hole, 0.11f, 1);
    const auto filled = touched(filled_session, camera, at);
    ASSERT_TRUE(filled);
    EXPECT_TRUE(filled->edits.empty());
    surface.show(subject(0, {{filled}}));
    EXPECT_EQ(surface.surface_at(camera, at[0]), first);
}

TEST_F(PaintSessions, ProjectAsEditDoes) {
    media::Image image(40, 30);
    for (uint32_t i = 0; i < 40 * 30; ++i) {
        uint8_t* to = image.at(i % 40, i / 40);
        to[0] = static_cast<uint8_t>(6 * (i % 40));
        to[3] = i % 40 < 30 ? 255 : 0;
    }
    stage::Camera onto = figure_camera(40);
    onto.height = 30;
    const editor::PaintOperation half{.opacity = 0.5f, .frames = {0, 1, edit::Follow::kNot}};
    render::Picker picker(device(), *field);
    const auto at = [&](float frame) {
        picker.show(frame);
        std::vector<voctree::LeafEdit> edits =
            edit::project(picker, clip->canvas, edit::densities(clip->canvas, frame), image, onto);
        for (voctree::LeafEdit& edit : edits) edit.alpha *= 0.5f;
        return edits;
    };
    {
        editor::PaintSession once(subject(), empty, half, {.image = image, .image_camera = onto});
        EXPECT_FALSE(once.add_projection(surface)) << "one step";
        voctree::EditLayer want = *empty;
        voctree::add_edits(want, edit::at_frames(clip->canvas, at(0), {0, 1, edit::Follow::kNot}));
        ASSERT_GT(want.edits.size(), 100u);
        EXPECT_EQ(once.layer()->edits, want.edits);
    }
    editor::PaintSession every(subject(), empty, half, {.image = image, .image_camera = onto, .every_frame = true});
    EXPECT_TRUE(every.add_projection(surface));
    EXPECT_FALSE(every.add_projection(surface));
    std::vector<voctree::LeafEdit> all;
    for (const float frame : {0.0f, 1.0f})
        for (voctree::LeafEdit edit : at(frame)) {
            edit.first = edit.last = frame;
            all.push_back(edit);
        }
    voctree::EditLayer want = *empty;
    voctree::add_edits(want, edit::extend_between_frames(all, 0, 1));
    EXPECT_EQ(every.layer()->edits, want.edits);
}

TEST(Images, AreReducedToMeans) {
    media::Image image(5, 2);
    for (uint32_t i = 0; i < 10; ++i) {
        uint8_t* to = image.at(i % 5, i / 5);
        to[0] = i % 5 == 1 ? 255 : 0;
        to[1] = 255;
        to[3] = i % 5 == 3 ? 0 : 255;
    }
    const media::Image small = editor::downscaled(image, 2);
    ASSERT_EQ(small.width, 3u);
    ASSERT_EQ(small.height, 1u);
    EXPECT_EQ(small.at(0, 0)[0], media::srgb_byte_from_linear(0.5f)) << "means of light, not of bytes";
    EXPECT_EQ(small.at(0, 0)[1], 255);
    EXPECT_EQ(small.at(1, 0)[1], 255) << "what is transparent has no colour";
    EXPECT_EQ(small.at(1, 0)[3], 128);
    EXPECT_EQ(small.at(2, 0)[3], 255);
}

}  // namespace
}  // namespace neuvv::test
