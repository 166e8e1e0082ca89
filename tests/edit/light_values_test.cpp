#include "edit/light_values.h"

#include <gtest/gtest.h>

#include "edit/operations.h"
#include "stage/stage.h"
#include "tests/stage/stage_files.h"

namespace neuvv {
namespace {

// The lights as the engine reads them.
void expect_as_loaded(const stage::StageFile& file, uint32_t node) {
    const stage::Stage stage = stage::make_stage(file);
    const stage::GltfLight& loaded = stage.scene.lights.at(static_cast<size_t>(stage.scene.nodes.at(node).light));
    const auto light = edit::light_on(file, node);
    ASSERT_TRUE(light);
    EXPECT_EQ(light->kind, loaded.kind);
    EXPECT_EQ(light->color, loaded.color);
    EXPECT_EQ(light->intensity, loaded.intensity);
    EXPECT_EQ(light->range_m, loaded.range_m);
    if (light->kind != stage::GltfLightKind::kSpot) return;
    EXPECT_NEAR(glm::radians(light->inner_cone_deg), loaded.inner_cone_rad, 1e-12);
    EXPECT_NEAR(glm::radians(light->outer_cone_deg), loaded.outer_cone_rad, 1e-12);
}

TEST(LightValues, AreThoseOfTheEngine) {
    const TemporaryFolder folder;
    stage::StageFile file = stage::read_stage_file(test::put_foreign_stage(folder.path));
    expect_as_loaded(file, edit::find_node(file, "Spot"));
    expect_as_loaded(file, edit::find_node(file, "Sun"));
    EXPECT_FALSE(edit::light_on(file, edit::find_node(file, "Floor")));
    edit::LightEdit edit;
    edit.kind = "spot";  // without any other value
    edit::add_light(file, "bare", edit, {});
    expect_as_loaded(file, edit::find_node(file, "bare"));
    edit.kind = "point";
    edit::set_light(file, edit::find_node(file, "bare"), edit);
    expect_as_loaded(file, edit::find_node(file, "bare"));
}

TEST(LightValues, SoftnessIsTheFadingPartOfTheCone) {
    EXPECT_DOUBLE_EQ(edit::softness_of(15, 30), 0.5);
    EXPECT_DOUBLE_EQ(edit::softness_of(0, 30), 1);
    for (const double softness : {0.0, 0.25, 0.5, 1.0})
        for (const double outer_deg : {0.5, 30.0, 90.0}) {
            const double inner_deg = edit::inner_cone_for(softness, outer_deg);
            EXPECT_LT(inner_deg, outer_deg) << "no file may have them alike";
            EXPECT_NEAR(edit::softness_of(inner_deg, outer_deg), softness, 1e-12);
        }
}

TEST(LightValues, EverySoftnessMakesASoundFile) {
    const TemporaryFolder folder;
    stage::StageFile file = stage::read_stage_file(test::put_foreign_stage(folder.path));
    const uint32_t node = edit::find_node(file, "Spot");
    for (const double softness : {0.0, 0.5, 1.0})
        for (const double outer_deg : {0.5, 90.0}) {
            edit::LightEdit edit;
            edit.outer_cone_deg = outer_deg;
            edit.inner_cone_deg = edit::inner_cone_for(softness, outer_deg);
            edit::set_light(file, node, edit);
            EXPECT_NO_THROW(stage::expect_sound_document(file)) << softness << ' ' << outer_deg;
        }
}

}  // namespace
}  // namespace neuvv
