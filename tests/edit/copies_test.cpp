// Copies of performers and other nodes, and what removing nodes takes with them.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "edit/edits.h"
#include "edit/operations.h"
#include "stage/evaluated_stage.h"
#include "stage/stage.h"
#include "support/input_error.h"
#include "support/near.h"

namespace neuvv::edits_test {
namespace {

TEST_F(Edits, ARingLooksOutwardAndComesLater) {
    edit::PerformerEdit edit;
    edit.clip = at("anna.nvv");
    edit::Placement placement;
    placement.at = glm::dvec3(0, 0.5, 3);
    edit::add_performer(file, "eva", edit, placement);
    edit::CopySettings ring{
        .count = 5, .pattern = edit::CopyPattern::kRing, .distance_m = 2, .stagger = {1, true}, .spin_step = 10};
    edit::duplicate_node(file, edit::find_node(file, "eva"), ring);
    const glm::dvec3 centre(0, 0.5, 1);
    std::set<std::pair<int, int>> positions;
    for (int i = 0; i < 6; ++i) {
        const stage::EvaluatedPerformer copy = performer(i == 0 ? "eva" : "eva " + std::to_string(i + 1), 0);
        const glm::dvec3 out = position(copy.world_from_performer) - centre;
        EXPECT_NEAR(glm::length(out), 2, 1e-6);
        expect_near(front(copy.world_from_performer), glm::normalize(out), 1e-5);
        EXPECT_NEAR(out.y, 0, 1e-9);
        positions.insert({std::lround(100 * out.x), std::lround(100 * out.z)});
        const stage::EvaluatedPerformer later = performer(i == 0 ? "eva" : "eva " + std::to_string(i + 1), 5 / 25.0);
        EXPECT_EQ(later.frame, 5 - i);
    }
    EXPECT_EQ(positions.size(), 6u);
    EXPECT_EQ(node("eva 4")["extensions"]["NEUVV_performer"]["spin"], 30);
    EXPECT_EQ(stage().clips.size(), 1u) << "all of one .nvv";
}

// Loops of seven frames, each two frames behind the one before: all run from the start of the stage on, none waits for
// its offset.
TEST_F(Edits, CopiesOfALoopRunFromTheStart) {
    const std::vector<std::pair<std::string, stage::ClipTime>> ways = {
        {"loop", {2, true}}, {"loop", {2 / 25.0, false}}, {"loop,speed:0.5", {4, true}}, {"loop", {-5, true}}};
    for (const auto& [time, stagger] : ways) {
        SetUp();
        edit::PerformerEdit edit;
        edit.clip = at("anna.nvv");
        edit.time = stage::parse_time_map(time, "test", "");
        edit::add_performer(file, "eva", edit, {});
        edit::duplicate_node(file, edit::find_node(file, "eva"), {.count = 4, .stagger = stagger});
        const double pace = time == "loop" ? 1 : 2;  // stage frames a frame of the clip
        for (int i = 0; i < 5; ++i)
            for (const int frame : {0, 1, 5, 30}) {
                const stage::EvaluatedPerformer copy =
                    performer(i == 0 ? "eva" : "eva " + std::to_string(i + 1), frame * pace / 25);
                EXPECT_EQ(copy.frame, (frame + 70 - 2 * i) % 7) << time << " copy " << i << " at " << frame;
            }
    }
    std::filesystem::remove(at("anna.nvv"));
    expect_input_error(
        [&] {
            edit::duplicate_node(file, edit::find_node(file, "eva"), {.stagger = {1, true}});
        },
        {"eva", "anna.nvv", "its clip"});
}

TEST_F(Edits, RowsAndFansStandWhereTheySay) {
    edit::PerformerEdit edit;
    edit.clip = at("anna.nvv");
    edit::add_performer(file, "eva", edit, {});
    edit::duplicate_node(file, edit::find_node(file, "eva"), {.count = 3, .distance_m = -0.5});
    expect_near(position(performer("eva 4").world_from_performer), {-1.5, 0, 0}, 1e-5);
    edit::duplicate_node(file, edit::find_node(file, "eva"),
                         {.count = 2, .pattern = edit::CopyPattern::kFan, .distance_m = 1, .arc_deg = 90});
    expect_near(position(performer("eva 6").world_from_performer), {1, 0, -1}, 1e-5);
    expect_near(front(performer("eva 6").world_from_performer), {1, 0, 0}, 1e-5);
}

// What a program shows before copies are made is where they come to stand.
TEST_F(Edits, CopiesStandWhereTheyWereForetold) {
    edit::PerformerEdit edit;
    edit.clip = at("anna.nvv");
    edit::Placement placement;
    placement.at = glm::dvec3(1, 0.5, 2);
    placement.turn_deg = glm::dvec3(0, 40, 0);
    placement.scale = glm::dvec3(1.5);
    using enum edit::CopyPattern;
    for (const edit::CopyPattern pattern : {kRow, kRing, kFan})
        for (const bool has_matrix : {false, true}) {
            SetUp();
            placement.matrix = has_matrix ? std::optional(glm::dmat4(2)) : std::nullopt;
            edit::add_performer(file, "eva", edit, placement);
            const edit::CopySettings settings{.count = 3, .pattern = pattern, .distance_m = 2, .arc_deg = 120};
            const std::vector<glm::dmat4> foretold =
                edit::copy_transforms(file, edit::find_node(file, "eva"), settings);
            ASSERT_EQ(foretold.size(), 3u);
            edit::duplicate_node(file, edit::find_node(file, "eva"), settings);
            for (int copy = 0; copy < 3; ++copy) {
                const glm::dmat4 stands = performer("eva " + std::to_string(copy + 2)).world_from_performer;
                for (int column = 0; column < 4; ++column)
                    expect_near(glm::dvec3(stands[column]), glm::dvec3(foretold[copy][column]), 1e-6);
            }
        }
    EXPECT_TRUE(edit::copy_transforms(file, 0, {.count = 4000000000u}).empty());
}

// Nodes below a copied node are copied with their animations; children stay children.
TEST_F(Edits, FamiliesAreCopied) {
    file.json.edit("animations")[0]["channels"][0]["target"]["node"] = 5;
    const size_t before = file.json["nodes"].size();
    edit::duplicate_node(file, edit::find_node(file, "Pivot"), {.count = 2, .distance_m = 3});
    EXPECT_EQ(file.json["nodes"].size(), before + 6);
    EXPECT_EQ(node("Pivot 3")["children"], ordered_json::parse("[10,11]"));
    EXPECT_EQ(file.json["animations"][0]["channels"].size(), 3u);
    const stage::Stage now = stage();
    EXPECT_EQ(now.performers.size(), 3u);
    EXPECT_EQ(stage::stage_at(now, 0).lights.size(), 4u);
    expect_near(position(performer("Anna 3").world_from_performer), {7, 0, 0}, 1e-5);
    expect_input_error([&] { edit::duplicate_node(file, edit::find_node(file, "Sun"), {}); }, {"Sun", "animated"});
    expect_input_error([&] { edit::duplicate_node(file, 0, {.count = 0}); }, {"0", "1 to 511"});
    expect_input_error([&] { edit::duplicate_node(file, 0, {.count = 4000000000u}); }, {"4000000000", "1 to 511"});
    expect_input_error([&] { edit::duplicate_node(file, 0, {.stagger = {1, true}}); }, {"Floor", "no performer"});
    expect_input_error([&] { edit::duplicate_node(file, 99, {}); }, {"99"});
}

// Each name is given once, however many names are taken already; a document without a scene lists each copy once.
TEST_F(Edits, CopiesHaveNamesOfTheirOwn) {
    file = stage::make_stage_file(at("bare.gltf"), R"({"asset": {"version": "2.0"},
        "nodes": [{"name": "a"}, {"name": "a 3", "children": [3]}, {"name": "a 513"}, {"name": "b"}, {}]})");
    edit::duplicate_node(file, 0, {.count = edit::kMaxCopies});
    edit::duplicate_node(file, 1, {.count = 2});
    edit::duplicate_node(file, 4, {.count = 1});
    ordered_json& nodes = file.json.edit("nodes");
    ASSERT_EQ(nodes.size(), 5 + edit::kMaxCopies + 4 + 1);
    EXPECT_EQ(nodes[5]["name"], "a 2");
    EXPECT_EQ(nodes[6]["name"], "a 4") << "\"a 3\" is another's";
    EXPECT_EQ(nodes[4 + edit::kMaxCopies]["name"], "a 514");
    EXPECT_EQ(nodes[5 + edit::kMaxCopies]["name"], "a 3 2");
    EXPECT_EQ(nodes[6 + edit::kMaxCopies]["name"], "b 2");
    std::set<std::string> names;
    for (const ordered_json& node : nodes) {
        const std::string name = node.value("name", "");
        EXPECT_TRUE(name.empty() || names.insert(name).second) << name;
    }
    const stage::Stage bare = stage();
    for (const stage::GltfNode& node : bare.scene.nodes) EXPECT_TRUE(node.in_scene) << node.name;
}

TEST_F(Edits, RemovingRenumbersEverything) {
    // A skin whose joints come after the removed nodes; a second animation that moves only the removed nodes.
    file.json.edit("skins") = {{{"joints", {3, 4}}, {"skeleton", 3}}};
    file.json.edit("cameras").push_back(file.json["cameras"][0]);
    file.json.edit("nodes").push_back({{"name", "B"}, {"camera", 1}});
    file.json.edit("scenes")[0]["nodes"].push_back(6);
    ordered_json channel = file.json["animations"][0]["channels"][0];
    ordered_json other = file.json["animations"][0];
    other["channels"][0]["target"]["node"] = 4;
    other["samplers"].insert(other["samplers"].begin(), other["samplers"][0]);
    channel["sampler"] = 0;
    other["channels"].push_back(channel);
    other["channels"][0]["sampler"] = 1;
    file.json.edit("animations").push_back(other);

    const std::string said = edit::remove_node(file, edit::find_node(file, "Camera"));
    EXPECT_NE(said.find("ACME_fog"), std::string::npos) << said;
    EXPECT_EQ(node("Pivot")["children"], ordered_json::parse("[3,4]"));
    EXPECT_EQ(file.json["scenes"][0]["nodes"], ordered_json::parse("[0,1,2,5]"));
    EXPECT_EQ(file.json["skins"][0]["joints"], ordered_json::parse("[2,3]"));
    EXPECT_EQ(file.json["skins"][0]["skeleton"], 2);
    EXPECT_EQ(file.json["cameras"].size(), 1u);
    EXPECT_EQ(node("B")["camera"], 0);
    ASSERT_EQ(file.json["animations"].size(), 1u) << "the one that moved the camera alone is gone";
    EXPECT_EQ(file.json["animations"][0]["samplers"].size(), 1u);
    EXPECT_EQ(file.json["animations"][0]["channels"].size(), 1u);
    EXPECT_EQ(file.json["animations"][0]["channels"][0]["target"]["node"], 3);
    EXPECT_EQ(file.json["animations"][0]["channels"][0]["sampler"], 0);
    file.json.erase("skins");  // without matrices, and not used by any node

    edit::remove_node(file, edit::find_node(file, "Spot"));
    const stage::Stage now = stage();
    ASSERT_EQ(now.scene.lights.size(), 1u);
    EXPECT_EQ(stage::stage_at(now, 0).lights.at(0).kind, stage::GltfLightKind::kDirectional);
}

TEST_F(Edits, RemovingTakesWhatOnlyItUsed) {
    edit::remove_node(file, edit::find_node(file, "Pivot"));
    EXPECT_TRUE(stage().performers.empty());
    EXPECT_EQ(file.json["nodes"].size(), 3u);
    const auto used = file.json["extensionsUsed"];
    EXPECT_EQ(std::count(used.begin(), used.end(), ordered_json("NEUVV_performer")), 0);
    EXPECT_EQ(std::count(used.begin(), used.end(), ordered_json("ACME_fog")), 1);
    edit::remove_node(file, edit::find_node(file, "Floor"));
    EXPECT_FALSE(file.json.contains("meshes"));
    edit::remove_light(file, edit::find_node(file, "Spot"));
    EXPECT_FALSE(file.json["extensions"].contains("KHR_lights_punctual"));
    EXPECT_FALSE(file.json.contains("extensionsRequired"));
    edit::remove_node(file, 0);
    EXPECT_FALSE(file.json.contains("nodes"));
    EXPECT_TRUE(stage().scene.nodes.empty());
}

TEST_F(Edits, JointsOfWhatStaysStay) {
    file.json.edit("skins") = {{{"joints", {5}}}};
    file.json.edit("nodes")[0]["skin"] = 0;
    expect_input_error([&] { edit::remove_node(file, 3); }, {"/skins/0", "joint"});
    edit::remove_node(file, 0);
    EXPECT_FALSE(file.json.contains("skins"));
    expect_input_error(
        [&] {
            file.json.edit("nodes")[1]["skin"] = 0;
            edit::duplicate_node(file, 1, {});
        },
        {"skin"});
}

}  // namespace
}  // namespace neuvv::edits_test
