// The tab of rendering: how the image is drawn, and the export of images and videos.
#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "edit/operations.h"
#include "media/colour.h"
#include "media/image_sink.h"
#include "tools/ui/icons.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/verbs/export.h"

namespace neuvv::viewer {

namespace {

constexpr const char* kSamples[] = {"1 ray a pixel", "4 rays", "9 rays", "16 rays"};
constexpr const char* kRenderKinds[] = {"video", "images", "one image"};
constexpr const char* kRanges[] = {"whole stage", "loop range"};
constexpr const char* kEndings[] = {".mp4", "_%04d.png", ".png"};

void image_fields(Context& context) {
    FieldGroup fields(context, "look");
    size_t layer = static_cast<size_t>(context.view.image.show);
    if (fields.choice("Layer", layer, kLayerNames)) context.view.image.show = static_cast<render::Show>(layer);
    if (context.view.image.show == render::Show::kCost) {
        double max = context.view.image.cost_max;
        if (fields.number("Brightest", max, {1, 100000, 4, "%.0f steps"}))
            context.view.image.cost_max = static_cast<float>(max);
    }
    size_t samples = static_cast<size_t>(context.view.image.samples - 1);
    if (fields.choice("When still", samples, kSamples)) context.view.image.samples = static_cast<int>(samples + 1);
    double scale = 100.0 * static_cast<double>(context.view.image.max_scale);
    if (fields.slider("While moving", scale, 20, 100, "at most %.0f %%"))
        context.view.image.max_scale = static_cast<float>(scale / 100);
    fields.toggle("Far levels", context.view.image.far_levels);
    fields.toggle("Own background", context.view.image.overrides_background);
    if (context.view.image.overrides_background) {
        glm::dvec3 colour = media::linear_from_srgb(context.view.image.background);
        if (fields.colour("Background", colour)) context.view.image.background = media::srgb_from_linear(colour);
    }
    if (context.frame.stage) {
        size_t blend = static_cast<size_t>(context.frame.stage->settings.blend);
        if (fields.choice("Performers", blend, stage::kStageBlendNames)) {
            edit::StageEdit edit;
            edit.blend = static_cast<stage::StageBlend>(blend);
            context.editor.edit([&](edit::Document& d) { return edit::set_stage(d.file, edit); });
        }
    }
    fields.toggle("Statistics", context.view.panels.statistics);
}

// The cameras that an export can use: the view of the window, the camera path, those of the stage.
std::vector<std::string> camera_names(const Context& context) {
    std::vector<std::string> names{"as seen here"};
    if (context.frame.stage->settings.camera_path) names.emplace_back(kAlongPath);
    for (const stage::EvaluatedCamera& camera : context.frame.evaluated.cameras)
        if (!camera.orthographic) names.push_back(camera.name);
    return names;
}

void size_fields(Context& context, FieldGroup& fields, ExportChoice& choice) {
    double width = choice.size.width, height = choice.size.height;
    if (fields.number("Width", width, {16, 8192, 2, "%.0f px"})) choice.size.width = static_cast<uint32_t>(width);
    if (fields.number("Height", height, {16, 8192, 2, "%.0f px"})) choice.size.height = static_cast<uint32_t>(height);
    for (const auto& [name, size] : {std::pair{"720p", media::ImageSize{1280, 720}},
                                     {"1080p", media::ImageSize{1920, 1080}},
                                     {"2160p", media::ImageSize{3840, 2160}}}) {
        if (ImGui::SmallButton(name)) choice.size = size;
        context.report.item(std::string("export/") + name);
        ImGui::SameLine();
    }
    ImGui::NewLine();
}

// A video has the sounds that the window plays.
void set_sound(const Context& context, ExportSettings& settings) {
    settings.heard_stage = context.frame.stage;
    std::vector<bool> heard;
    for (const stage::StagePerformer& performer : context.frame.stage->performers)
        heard.push_back(context.view.hears(performer.name));
    settings.is_heard = [heard = std::move(heard)](uint32_t performer) { return heard[performer]; };
}

// The settings of an export, without its output.
ExportSettings settings_of(const Context& context, const ExportChoice& choice) {
    ExportSettings settings;
    settings.size = choice.size;
    settings.samples = static_cast<uint32_t>(choice.samples + 1);
    settings.far_levels = context.view.image.far_levels;
    settings.fps = choice.fps > 0 ? choice.fps : context.frame.stage->fps;
    settings.with_background = !choice.transparent;
    settings.first_s = context.view.clock.displayed_s();
    if (choice.kind != 2) {
        settings.first_s = choice.range == 0 ? 0 : context.view.clock.in_s();
        const double last_s = choice.range == 0 ? context.view.clock.duration_s() : context.view.clock.out_s();
        settings.images = static_cast<uint32_t>(std::max(1.0, std::round((last_s - settings.first_s) * settings.fps)));
    }
    if (choice.kind == 0) set_sound(context, settings);
    const std::optional<stage::CameraPath>& path = context.frame.stage->settings.camera_path;
    if (path && (choice.camera == kAlongPath || (choice.camera.empty() && context.view.along_path))) {
        settings.camera = [path = *path, size = choice.size](const stage::Stage&,
                                                             const stage::EvaluatedStage& evaluated) {
            return stage::camera_at(path, evaluated.time_s, size.width, size.height);
        };
    } else if (choice.camera.empty()) {
        settings.camera = [eye = context.view.eye, size = choice.size](const stage::Stage&,
                                                                       const stage::EvaluatedStage&) {
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

void begin_export(Context& context, Exporter& exporter, ExportSettings settings, const std::filesystem::path& file) {
    try {
        settings.output = media::parse_output(file.string());
        exporter.begin(context, std::make_shared<Export>(std::move(settings)));
    } catch (const InputError& problem) {
        context.editor.notify(problem.what(), true);
    }
}

// Where the selected camera no longer exists, a notice says so, and the view of the window is selected.
void camera_field(Context& context, FieldGroup& fields, ExportChoice& choice) {
    const std::vector<std::string> names = camera_names(context);
    std::vector<const char*> texts;
    for (const std::string& name : names) texts.push_back(name.c_str());
    const auto found = std::find(names.begin() + 1, names.end(), choice.camera);
    if (!choice.camera.empty() && found == names.end()) {
        context.editor.notify(fmt::format("\"{}\" is gone: what is exported is {}", choice.camera, names[0]), true);
        choice.camera.clear();
    }
    size_t selected = choice.camera.empty() ? 0 : static_cast<size_t>(found - names.begin());
    if (fields.choice("Camera", selected, texts)) choice.camera = selected == 0 ? "" : names[selected];
}

void export_fields(Context& context, ExportChoice& choice, Files& files, Exporter& exporter) {
    FieldGroup fields(context, "export");
    fields.choice("Kind", choice.kind, kRenderKinds);
    size_fields(context, fields, choice);
    camera_field(context, fields, choice);
    if (choice.kind != 2) {
        fields.choice("Time", choice.range, kRanges);
        double fps = choice.fps > 0 ? choice.fps : context.frame.stage->fps;
        if (fields.number("Frame rate", fps, {1, 240, 0.1, "%.2f fps"})) choice.fps = fps;
    }
    fields.choice("Rays", choice.samples, kSamples);
    if (choice.kind != 0) fields.toggle("Transparent", choice.transparent);
    if (ImGui::Button(ICON_FILM "  Export…", {-FLT_MIN, 0})) {
        const std::string stem = context.editor.file().path.stem().string();
        files.ask_path("Export", {choice.kind == 0 ? ".mp4" : ".png"}, true, stem + kEndings[choice.kind],
                       [&context, &exporter, settings = settings_of(context, choice)](
                           const std::filesystem::path& file) { begin_export(context, exporter, settings, file); });
    }
    context.report.item("export/start");
}

void export_progress(Context& context, const Exporter& exporter) {
    Export& job = *exporter.job();
    const uint32_t done = job.finished_images(), all = job.settings().images;
    const double seconds = context.frame.now_s - exporter.begin_s();
    const std::string left = done > 0 ? fmt::format("{:.0f} s left", seconds / done * (all - done)) : "…";
    ImGui::TextWrapped("%s", job.settings().output.path.string().c_str());
    const std::string text = done < all ? fmt::format("{} of {}, {}", done, all, left) : "adds the sound";
    ImGui::ProgressBar(static_cast<float>(done) / static_cast<float>(all), {-FLT_MIN, 0}, text.c_str());
    context.report.item("export/progress");
    if (ImGui::Button(ICON_STOP "  Cancel", {-FLT_MIN, 0})) job.cancel();
    context.report.item("export/cancel");
}

}  // namespace

void render_tab(Context& context, ExportChoice& choice, Files& files, Exporter& exporter) {
    if (ImGui::CollapsingHeader("Image", ImGuiTreeNodeFlags_DefaultOpen)) image_fields(context);
    context.report.item("render/Image");
    const bool open = ImGui::CollapsingHeader("Export", ImGuiTreeNodeFlags_DefaultOpen);
    context.report.item("render/Export");
    if (!open) return;
    if (exporter.job())
        export_progress(context, exporter);
    else if (context.frame.stage)
        export_fields(context, choice, files, exporter);
}

}  // namespace neuvv::viewer
