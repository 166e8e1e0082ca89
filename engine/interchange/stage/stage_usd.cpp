#include "interchange/stage/stage_usd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/output_path.h"
#include "interchange/stage/camera_usd.h"
#include "interchange/usd/usd_writer.h"
#include "stage/camera_path.h"
#include "stage/evaluated_stage.h"

namespace neuvv::interchange {

namespace {

constexpr double kLightRadius_m = 0.01;  // so small that OpenUSD's lights, too, are points

class LayoutWriter {
  public:
    LayoutWriter(const std::filesystem::path& file, const stage::Stage& stage, const StageLayout& layout);
    std::string text();

  private:
    template <typename Of>
    std::vector<std::string> each(const Of& of) const {
        std::vector<std::string> values;
        for (const stage::EvaluatedStage& time : times_) values.push_back(of(time));
        return values;
    }
    // An asset's path relative to the file.
    std::string asset(const std::filesystem::path& path) const;
    void add_performer(size_t index);
    void add_scenery();
    void add_light(const stage::EvaluatedLight& light);
    void add_camera(size_t index);

    std::filesystem::path folder_;
    const stage::Stage& stage_;
    const StageLayout& layout_;
    std::vector<stage::EvaluatedStage> times_;
    UsdNames names_;
    std::string text_;
};

LayoutWriter::LayoutWriter(const std::filesystem::path& file, const stage::Stage& stage, const StageLayout& layout)
    : folder_(stage::absolute_path(file).parent_path()), stage_(stage), layout_(layout) {
    const double count = std::floor(stage.duration_s * layout.fps + 1e-6) + 1;
    if (!(count <= static_cast<double>(stage::kMaxPathKeys)))
        throw InputError(stage.file.path.string(), "",
                         fmt::format("lasts {:.6g} s, more than {} samples", stage.duration_s, stage::kMaxPathKeys),
                         "choose fewer of them a second");
    for (double i = 0; i < count; ++i) times_.push_back(stage::stage_at(stage, i / layout.fps));
}

std::string LayoutWriter::asset(const std::filesystem::path& path) const {
    const std::string relative = stage::absolute_path(path).lexically_relative(folder_).generic_string();
    std::string text = relative.starts_with("..") ? relative : "./" + relative;
    for (size_t at = 0; (at = text.find("@@@", at)) != std::string::npos; at += 4) text.insert(at, "\\");
    return "@@@" + text + "@@@";
}

void LayoutWriter::add_performer(size_t index) {
    const stage::StagePerformer& performer = stage_.performers[index];
    const std::filesystem::path splats = layout_.splats / (performer.name + ".usda");
    std::error_code error;
    const bool has_splats = !layout_.splats.empty() && std::filesystem::is_regular_file(splats, error);
    text_ += fmt::format("    def Xform {} (\n", usd_quoted(names_.take(performer.name)));
    if (has_splats) text_ += fmt::format("        prepend references = {}\n", asset(splats));
    text_ += fmt::format("        doc = {}\n    )\n    {{\n", usd_quoted(performer.name));
    const std::string indent = "        ";
    const auto at = [&](const stage::EvaluatedStage& time) -> const stage::EvaluatedPerformer& {
        return time.performers[index];
    };
    append_usd_values(text_, indent, "matrix4d xformOp:transform",
                      each([&](const auto& time) { return usd_matrix(at(time).world_from_performer); }));
    append_usd_values(text_, indent, "token visibility", each([&](const auto& time) {
                          return std::string(at(time).visible ? "\"inherited\"" : "\"invisible\"");
                      }));
    append_usd_values(text_, indent, "custom double neuvv:frame",
                      each([&](const auto& time) { return fmt::format("{:.6g}", at(time).frame); }));
    text_ += fmt::format("        custom string neuvv:clip = {}\n",
                         usd_quoted(stage_.clips[performer.clip].path.filename().string()));
    text_ += "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }\n";
}

void LayoutWriter::add_scenery() {
    const bool has_meshes = std::any_of(stage_.scene.nodes.begin(), stage_.scene.nodes.end(),
                                        [](const stage::GltfNode& node) { return node.draws_mesh(); });
    if (!has_meshes) return;
    text_ += fmt::format("    def Xform {} (\n        prepend references = {}\n    )\n    {{\n    }}\n",
                         usd_quoted(names_.take("Scenery")), asset(stage_.file.path));
}

// The light of a node, with the colour and strength that it has at the begin: only its transform changes.
void LayoutWriter::add_light(const stage::EvaluatedLight& light) {
    const stage::GltfNode& node = stage_.scene.nodes[light.node];
    const bool distant = light.kind == stage::GltfLightKind::kDirectional;
    const bool spot = light.kind == stage::GltfLightKind::kSpot;
    text_ += fmt::format("    def {} {} (\n", distant ? "DistantLight" : "SphereLight",
                         usd_quoted(names_.take(stage::node_title(stage_.scene, light.node))));
    if (spot) text_ += "        prepend apiSchemas = [\"ShapingAPI\"]\n";
    text_ += fmt::format("        doc = {}\n    )\n    {{\n", usd_quoted(node.name));
    const std::string indent = "        ";
    const double brightest = std::max({light.intensity.x, light.intensity.y, light.intensity.z, 1e-9});
    const glm::dvec3 colour = light.intensity / brightest;
    text_ += fmt::format("        color3f inputs:color = ({:.6g}, {:.6g}, {:.6g})\n", colour.x, colour.y, colour.z);
    text_ += fmt::format("        float inputs:intensity = {:.6g}\n", distant ? brightest : 4 * brightest);
    text_ += "        bool inputs:normalize = 1\n";
    if (!distant)
        text_ += fmt::format("        float inputs:radius = {:.6g}\n        bool treatAsPoint = 1\n", kLightRadius_m);
    if (spot)
        text_ += fmt::format(
            "        float inputs:shaping:cone:angle = {:.6g}\n"
            "        float inputs:shaping:cone:softness = {:.6g}\n",
            glm::degrees(std::acos(light.cos_outer)), 1 - std::acos(light.cos_inner) / std::acos(light.cos_outer));
    // Both light along −Z.
    append_usd_values(text_, indent, "matrix4d xformOp:transform", each([&](const stage::EvaluatedStage& time) {
                          glm::dmat4 world = time.pose.world_from_node[light.node];
                          for (int i = 0; i < 3; ++i) world[i] /= std::max(glm::length(world[i]), 1e-12);
                          return usd_matrix(world);
                      }));
    text_ += "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }\n";
}

void LayoutWriter::add_camera(size_t index) {
    const stage::CameraPath path = stage::path_of_camera(stage_, index, layout_.fps);
    text_ += usd_camera_prim(names_.take(times_[0].cameras[index].name), stage::by_images(path, layout_.fps, 1280, 720),
                             "    ");
}

std::string LayoutWriter::text() {
    text_ = fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"Stage\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n    startTimeCode = 0\n"
        "    endTimeCode = {}\n    timeCodesPerSecond = {:.9g}\n    framesPerSecond = {:.9g}\n)\n\n"
        "def Xform \"Stage\" (\n    kind = \"assembly\"\n)\n{{\n",
        times_.size() - 1, layout_.fps, layout_.fps);
    for (size_t i = 0; i < stage_.performers.size(); ++i) add_performer(i);
    add_scenery();
    for (const stage::EvaluatedLight& light : times_[0].lights) add_light(light);
    for (size_t i = 0; i < times_[0].cameras.size(); ++i)
        if (!times_[0].cameras[i].orthographic) add_camera(i);
    if (stage_.settings.camera_path)
        text_ += usd_camera_prim(names_.take("path"),
                                 stage::by_images(*stage_.settings.camera_path, layout_.fps, 1280, 720), "    ");
    return text_ + "}\n";
}

}  // namespace

void write_stage_usda(const std::filesystem::path& file, const stage::Stage& stage, const StageLayout& layout) {
    write_text_file(file, LayoutWriter(file, stage, layout).text());
}

}  // namespace neuvv::interchange
