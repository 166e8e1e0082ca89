// The tab of rendering: how the image is drawn here, and images and videos to take away.
#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/operations.h"
#include "media/colour.h"
#include "tools/ui/icons.h"
#include "tools/viewer/export.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

constexpr const char* kSamples[] = {"1 ray a pixel", "4 rays", "9 rays", "16 rays"};
constexpr const char* kKinds[] = {"video", "pictures", "one image"};
constexpr const char* kRanges[] = {"whole stage", "loop range"};
constexpr const char* kEndings[] = {".mp4", "_%04d.png", ".png"};

void look_fields(Viewer& viewer) {
    FieldGroup fields(viewer, "look");
    size_t layer = static_cast<size_t>(viewer.image.show);
    if (fields.choice("Layer", layer, kLayerNames)) viewer.image.show = static_cast<render::Show>(layer);
    if (viewer.image.show == render::Show::kCost) {
        double most = viewer.image.cost_max;
        if (fields.number("Brightest", most, {1, 100000, 4, "%.0f steps"}))
            viewer.image.cost_max = static_cast<float>(most);
    }
    size_t samples = static_cast<size_t>(viewer.image.samples - 1);
    if (fields.choice("When still", samples, kSamples)) viewer.image.samples = static_cast<int>(samples + 1);
    double scale = 100.0 * static_cast<double>(viewer.image.most_scale);
    if (fields.slider("While moving", scale, 20, 100, "at most %.0f %%"))
        viewer.image.most_scale = static_cast<float>(scale / 100);
    fields.toggle("Own background", viewer.image.own_background);
    if (viewer.image.own_background) {
        glm::dvec3 colour = media::linear_from_srgb(viewer.image.background);
        if (fields.colour("Background", colour)) viewer.image.background = media::srgb_from_linear(colour);
    }
    if (viewer.stage) {
        size_t blend = static_cast<size_t>(viewer.stage->settings.blend);
        if (fields.choice("Performers", blend, stage::kStageBlendNames)) {
            edit::StageEdit edit;
            edit.blend = static_cast<stage::StageBlend>(blend);
            viewer.editor.edit([&](edit::Document& d) { return edit::set_stage(d.file, edit); });
        }
    }
    fields.toggle("Speed", viewer.panels.speed);
}

// What a camera of the export is called: the view of the window, the path, those of the stage.
std::vector<std::string> camera_names(const Viewer& viewer) {
    std::vector<std::string> names{"as seen here"};
    if (viewer.stage->settings.camera_path) names.emplace_back(kAlongPath);
    for (const stage::EvaluatedCamera& camera : viewer.evaluated.cameras)
        if (!camera.orthographic) names.push_back(camera.name);
    return names;
}

void size_fields(Viewer& viewer, FieldGroup& fields, ExportChoice& choice) {
    double width = choice.size.width, height = choice.size.height;
    if (fields.number("Width", width, {16, 8192, 2, "%.0f px"})) choice.size.width = static_cast<uint32_t>(width);
    if (fields.number("Height", height, {16, 8192, 2, "%.0f px"})) choice.size.height = static_cast<uint32_t>(height);
    for (const auto& [name, size] : {std::pair{"720p", media::ImageSize{1280, 720}},
                                     {"1080p", media::ImageSize{1920, 1080}},
                                     {"2160p", media::ImageSize{3840, 2160}}}) {
        if (ImGui::SmallButton(name)) choice.size = size;
        viewer.report.item(std::string("export/") + name);
        ImGui::SameLine();
    }
    ImGui::NewLine();
}

// All but where it goes.
ExportSettings chosen_export(Viewer& viewer) {
    const ExportChoice& choice = viewer.export_choice;
    ExportSettings settings;
    settings.size = choice.size;
    settings.samples = static_cast<uint32_t>(choice.samples + 1);
    settings.fps = choice.fps > 0 ? choice.fps : viewer.stage->fps;
    settings.with_background = !choice.transparent;
    settings.first_s = viewer.clock.shown_s();
    if (choice.kind != 2) {
        settings.first_s = choice.range == 0 ? 0 : viewer.clock.in_s();
        const double last_s = choice.range == 0 ? viewer.clock.duration_s() : viewer.clock.out_s();
        settings.images = static_cast<uint32_t>(std::max(1.0, std::round((last_s - settings.first_s) * settings.fps)));
    }
    const std::optional<stage::CameraPath>& path = viewer.stage->settings.camera_path;
    if (path && (choice.camera == kAlongPath || (choice.camera.empty() && viewer.along_path))) {
        settings.camera = [path = *path, size = choice.size](const stage::Stage&,
                                                             const stage::EvaluatedStage& evaluated) {
            return stage::camera_at(path, evaluated.time_s, size.width, size.height);
        };
    } else if (choice.camera.empty()) {
        settings.camera = [eye = viewer.eye, size = choice.size](const stage::Stage&, const stage::EvaluatedStage&) {
            return camera_of(eye, size.width, size.height);
        };
    } else {
        settings.camera = [name = choice.camera, size = choice.size](const stage::Stage& stage,
                                                                     const stage::EvaluatedStage& evaluated) {
            return stage::camera_of(stage, name, evaluated, size.width, size.height);
        };
    }
    return settings;
}

void begin_export(Viewer& viewer, ExportSettings settings, const std::filesystem::path& file) {
    try {
        settings.output = tools::parse_output(file.string());
        viewer.begin_export(std::make_shared<Export>(std::move(settings)));
    } catch (const InputError& problem) {
        viewer.editor.notify(problem.what(), true);
    }
}

// One that is gone is told, and the window's view takes its place.
void camera_field(Viewer& viewer, FieldGroup& fields, ExportChoice& choice) {
    const std::vector<std::string> names = camera_names(viewer);
    std::vector<const char*> texts;
    for (const std::string& name : names) texts.push_back(name.c_str());
    const auto found = std::find(names.begin() + 1, names.end(), choice.camera);
    if (!choice.camera.empty() && found == names.end()) {
        viewer.editor.notify(fmt::format("\"{}\" is gone: what is exported is {}", choice.camera, names[0]), true);
        choice.camera.clear();
    }
    size_t chosen = choice.camera.empty() ? 0 : static_cast<size_t>(found - names.begin());
    if (fields.choice("Camera", chosen, texts)) choice.camera = chosen == 0 ? "" : names[chosen];
}

void export_fields(Viewer& viewer) {
    ExportChoice& choice = viewer.export_choice;
    FieldGroup fields(viewer, "export");
    fields.choice("Kind", choice.kind, kKinds);
    size_fields(viewer, fields, choice);
    camera_field(viewer, fields, choice);
    if (choice.kind != 2) {
        fields.choice("Time", choice.range, kRanges);
        double fps = choice.fps > 0 ? choice.fps : viewer.stage->fps;
        if (fields.number("Images a second", fps, {1, 240, 0.1, "%.2f"})) choice.fps = fps;
    }
    fields.choice("Rays", choice.samples, kSamples);
    if (choice.kind != 0) fields.toggle("Transparent", choice.transparent);
    if (ImGui::Button(ICON_FILM "  Export…", {-FLT_MIN, 0})) {
        const std::string stem = viewer.editor.file().path.stem().string();
        viewer.files.ask_path("Export", {choice.kind == 0 ? ".mp4" : ".png"}, true, stem + kEndings[choice.kind],
                              [&viewer, settings = chosen_export(viewer)](const std::filesystem::path& file) {
                                  begin_export(viewer, settings, file);
                              });
    }
    viewer.report.item("export/start");
}

void export_progress(Viewer& viewer) {
    Export& job = *viewer.exporting;
    const uint32_t done = job.finished_images(), all = job.settings().images;
    const double seconds = viewer.now_s - viewer.export_begin_s;
    const std::string left = done > 0 ? fmt::format("{:.0f} s left", seconds / done * (all - done)) : "…";
    ImGui::TextWrapped("%s", job.settings().output.path.string().c_str());
    ImGui::ProgressBar(static_cast<float>(done) / static_cast<float>(all), {-FLT_MIN, 0},
                       fmt::format("{} of {}, {}", done, all, left).c_str());
    viewer.report.item("export/progress");
    if (ImGui::Button(ICON_STOP "  Cancel", {-FLT_MIN, 0})) job.cancel();
    viewer.report.item("export/cancel");
}

}  // namespace

void render_tab(Viewer& viewer) {
    if (ImGui::CollapsingHeader("Picture", ImGuiTreeNodeFlags_DefaultOpen)) look_fields(viewer);
    viewer.report.item("render/Picture");
    const bool open = ImGui::CollapsingHeader("Export", ImGuiTreeNodeFlags_DefaultOpen);
    viewer.report.item("render/Export");
    if (!open) return;
    if (viewer.exporting)
        export_progress(viewer);
    else if (viewer.stage)
        export_fields(viewer);
}

}  // namespace neuvv::viewer
