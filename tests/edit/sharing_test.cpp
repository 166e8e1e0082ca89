// Edits cost what they change: documents, steps of the history and stages share all else.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "edit/history.h"
#include "edit/operations.h"
#include "stage/evaluated_stage.h"
#include "support/input_error.h"
#include "tests/edit/foreign_stage.h"

namespace neuvv {
namespace {

using nlohmann::ordered_json;

template <typename Vector>
std::string numbers(const Vector& vector, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += fmt::format(" {}", vector[i]);
    return text;
}

std::string text_of(const stage::GltfNode& node) {
    std::string text =
        fmt::format("node {} parent {} mesh {} skin {} camera {} light {} {}{}{}", node.name, node.parent, node.mesh,
                    node.skin, node.camera, node.light, node.in_scene, node.visible, node.has_matrix);
    for (int column = 0; column < 4; ++column) text += numbers(node.matrix[column], 4);
    text += numbers(node.translation, 3) + numbers(node.rotation, 4) + numbers(node.scale, 3);
    for (const uint32_t child : node.children) text += fmt::format(" child {}", child);
    for (const float weight : node.weights) text += fmt::format(" weight {}", weight);
    return text + "\n";
}

std::string text_of(const stage::GltfScene& scene) {
    std::string text = fmt::format("{} root {}\n", scene.file, scene.root);
    for (const stage::GltfNode& node : scene.nodes) text += text_of(node);
    for (const uint32_t node : scene.order) text += fmt::format("{} ", node);
    for (const stage::GltfMesh& mesh : scene.meshes)
        for (const stage::GltfPrimitive& primitive : mesh.primitives) {
            text += fmt::format("\nmesh {} material {}", mesh.name, primitive.material);
            for (const glm::vec3& position : primitive.positions) text += numbers(position, 3);
            for (const glm::vec2& uv : primitive.uvs) text += numbers(uv, 2);
        }
    for (const stage::GltfMaterial& material : scene.materials)
        text += fmt::format("\nmaterial {} {} {}", material.name, material.metallic, material.texture);
    for (const auto& image : scene.images) text += fmt::format("\nimage {}", image ? image->pixels.width : 0);
    for (const stage::GltfAnimation& animation : scene.animations) {
        text += fmt::format("\nanimation {} {}", animation.name, animation.duration_s);
        for (const stage::GltfChannel& channel : animation.channels)
            text +=
                fmt::format(" node {} values {} last {}", channel.node, channel.values.size(), channel.values.back());
    }
    for (const stage::GltfSkin& skin : scene.skins) text += fmt::format("\nskin of {}", skin.joints.size());
    for (const stage::GltfCamera& camera : scene.cameras)
        text += fmt::format("\ncamera {} {}", camera.name, camera.vertical_angle_rad);
    for (const stage::GltfLight& light : scene.lights)
        text += fmt::format("\nlight {} {} {} {}", light.name, light.intensity, light.range_m, light.outer_cone_rad);
    return text;
}

// Everything of a stage that depends on its document.
std::string text_of(const stage::Stage& stage) {
    std::string text =
        text_of(stage.scene) + fmt::format("\n{} s, {} fps{}{}", stage.duration_s, stage.fps, numbers(stage.ambient, 3),
                                           numbers(stage.settings.background, 3));
    for (const stage::StagePerformer& performer : stage.performers)
        text += fmt::format("\nperformer {} {} {} {} {}", performer.node, performer.name, performer.clip,
                            stage.clips[performer.clip].path.string(), stage::json_of(performer.settings).dump());
    return text + "\n" + stage.file.json.text();
}

struct Sharing : test::ForeignDocument {
    uint32_t node(const std::string& name) const { return edit::find_node(document.file, name); }
    std::string move_to(const std::string& name, const glm::dvec3& at) {
        edit::Placement placement;
        placement.at = at;
        return edit::place_node(document.file, node(name), placement);
    }
    // The next stage, made from the last one. It must be the same as one made from the document alone.
    stage::Stage next(const stage::Stage& before) const {
        stage::Stage made = stage::make_stage(document.file, &before);
        EXPECT_EQ(text_of(made), text_of(stage::make_stage(document.file)));
        return made;
    }
};

TEST_F(Sharing, AnEditCopiesTheMembersThatItChanges) {
    const edit::Document before = document;
    move_to("Anna", {1, 2, 3});
    for (const auto& [name, value] : before.file.json.members())
        EXPECT_EQ(document.file.json.shares(before.file.json, name), name != "nodes") << name;
    edit::duplicate_node(document.file, node("Anna"), {.count = 2});
    edit::remove_node(document.file, node("Anna 2"));
    edit::LightEdit light;
    light.intensity = 7;
    edit::set_light(document.file, node("Spot"), light);
    for (const char* name : {"buffers", "bufferViews", "accessors", "meshes", "materials", "images", "animations"})
        EXPECT_TRUE(document.file.json.shares(before.file.json, name)) << name;
    EXPECT_FALSE(document.file.json.shares(before.file.json, "extensions"));
}

TEST_F(Sharing, HistoryCountsItsJson) {
    document.file.json.edit("nodes")[0]["extras"] = {{"notes", std::string(100000, 'n')}};
    document.file.json.edit("images")[0]["extras"] = {{"notes", std::string(1000000, 'n')}};
    edit::History history(100, 350000);
    const auto step = [&](int i) {
        edit::Document before = document;
        std::string said = move_to("Anna", {i, 0, 0});
        history.add_step(std::move(before), document, std::move(said));
    };
    step(1);
    const uint64_t one = history.extra_bytes(document);
    EXPECT_GT(one, 100000u) << "the nodes as they were";
    EXPECT_LT(one, 150000u) << "the images are the document's";
    step(2);
    EXPECT_NEAR(static_cast<double>(history.extra_bytes(document)), 2.0 * static_cast<double>(one), 1000);
    for (int i = 3; i <= 10; ++i) step(i);
    EXPECT_LE(history.extra_bytes(document), 350000u);
    int steps = 0;
    while (history.undo(document)) ++steps;
    EXPECT_EQ(steps, 3) << "the oldest were forgotten";
    EXPECT_GT(history.extra_bytes(document), 2 * one) << "what is to be done again counts, too";
}

TEST_F(Sharing, StagesShareWhatIsMadeOfBytes) {
    const stage::Stage first = stage::make_stage(document.file);
    move_to("Anna", {1, 2, 3});
    const stage::Stage moved = next(first);
    EXPECT_TRUE(moved.scene.meshes.shares(first.scene.meshes));
    EXPECT_TRUE(moved.scene.animations.shares(first.scene.animations));
    EXPECT_EQ(moved.scene.images.at(0), first.scene.images.at(0));
    EXPECT_EQ(moved.scene.nodes[node("Anna")].translation, glm::dvec3(1, 2, 3));
    EXPECT_NE(text_of(moved), text_of(first)) << "the comparison sees a node that moved";
    document.file.json.edit("materials")[0]["name"] = "Stone";
    const stage::Stage other = next(moved);
    EXPECT_FALSE(other.scene.meshes.shares(first.scene.meshes));
    EXPECT_EQ(other.scene.materials.at(0).name, "Stone");
    edit::save_document(document, at("stage.gltf"));
    EXPECT_TRUE(next(other).scene.meshes.shares(other.scene.meshes)) << "saving changes nothing";
}

TEST_F(Sharing, FilesThatChangedAreReadAgain) {
    const stage::Stage first = stage::make_stage(document.file);
    std::string buffer = test::foreign_buffer();
    const float moved = -7;
    buffer.replace(0, sizeof moved, reinterpret_cast<const char*>(&moved), sizeof moved);
    write_text(at("stage data.bin"), buffer);
    std::filesystem::last_write_time(at("stage data.bin"),
                                     std::filesystem::file_time_type::clock::now() + std::chrono::seconds(2));
    EXPECT_EQ(next(first).scene.meshes[0].primitives[0].positions[0].x, -7);
    std::filesystem::remove(at("stage data.bin"));
    expect_input_error([&] { stage::make_stage(document.file, &first); }, {"stage%20data.bin"});
}

// Problems are reported as they are where nothing is shared.
TEST_F(Sharing, ProblemsAreFoundInWhatIsShared) {
    const stage::Stage first = stage::make_stage(document.file);
    const stage::StageJson sound = document.file.json;
    const auto expect_same_problem = [&](const std::function<void(ordered_json & nodes)>& edit) {
        document.file.json = sound;
        edit(document.file.json.edit("nodes"));
        std::string problem;
        try {
            stage::make_stage(document.file);
        } catch (const InputError& error) {
            problem = error.what();
        }
        EXPECT_NE(problem, "");
        expect_input_error([&] { stage::make_stage(document.file, &first); }, {problem});
        expect_input_error([&] { stage::expect_sound_document(document.file, &first); }, {problem});
    };
    expect_same_problem([](ordered_json& nodes) { nodes[0]["mesh"] = 3; });
    expect_same_problem([](ordered_json& nodes) { nodes[1]["camera"] = 3; });
    expect_same_problem([](ordered_json& nodes) { nodes[0]["mesh"] = "no index"; });
    expect_same_problem([](ordered_json& nodes) { nodes[4]["translation"] = {0, 0}; });
    expect_same_problem([](ordered_json& nodes) {  // which is animated
        nodes[1].erase("rotation");
        nodes[1].erase("translation");
        nodes[1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    });
    expect_same_problem([](ordered_json& nodes) { nodes[3]["children"] = {3}; });
}

TEST_F(Sharing, RandomEditsMakeTheStagesOfTheirDocuments) {
    std::mt19937 random(21);
    const auto number = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    const auto any_node = [&] {
        return static_cast<uint32_t>(random() % static_cast<uint32_t>(document.file.json["nodes"].size()));
    };
    edit::History history;
    edit::PerformerEdit performer;
    performer.clip = at("anna.nvv");
    const std::vector<std::function<std::string(stage::StageFile&)>> operations = {
        [&](auto& file) {
            edit::Placement placement;
            placement.at = glm::dvec3(number(-5, 5), number(0, 2), number(-5, 5));
            placement.turn_deg = glm::dvec3(0, number(0, 360), 0);
            return edit::place_node(file, any_node(), placement);
        },
        [&](auto& file) { return edit::rename_node(file, any_node(), "name"); },
        [&](auto& file) { return edit::add_performer(file, "", performer, {}); },
        [&](auto& file) { return edit::duplicate_node(file, any_node(), {.count = 2}); },
        [&](auto& file) { return edit::remove_node(file, any_node()); },
        [&](auto& file) { return edit::add_light(file, "", {}, {}); },
        [&](auto& file) { return edit::add_camera(file, "", number(0.3, 1), glm::dmat4(1)); },
        [&](auto& file) { return edit::show_node(file, any_node(), random() % 2 == 0); },
        [&](auto& file) {
            edit::StageEdit stage;
            stage.background = glm::dvec3(number(0, 1));
            return edit::set_stage(file, stage);
        },
    };
    stage::Stage stage = stage::make_stage(document.file);
    int done = 0, shared = 0;
    for (int i = 0; i < 300; ++i) {
        if (random() % 5 == 0) {
            random() % 2 == 0 ? history.undo(document) : history.redo(document);
        } else {
            edit::Document before = document;
            try {
                std::string said = operations[random() % operations.size()](document.file);
                history.add_step(std::move(before), document, std::move(said));
            } catch (const InputError&) {
                EXPECT_EQ(document.file.json, before.file.json);
                continue;
            }
        }
        if (document.file.json.value("nodes", ordered_json()).empty()) history.undo(document);
        const stage::Stage now = next(stage);
        shared += now.scene.meshes.shares(stage.scene.meshes);
        stage = now;
        ++done;
    }
    EXPECT_GT(done, 200);
    EXPECT_GT(shared, done / 2);
}

}  // namespace
}  // namespace neuvv
