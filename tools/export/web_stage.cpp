// Stages for browsers: a folder with a page that plays the stage, and with all that is on it.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text.h"
#include "edit/operations.h"
#include "render/clips/light_status.h"
#include "stage/evaluated_stage.h"
#include "stage/gltf/embedded.h"
#include "stream/transport/byte_source.h"
#include "tools/export/stage_kinds.h"
#include "tools/publish/encode_scene.h"
#include "tools/publish/published_files.h"
#include "tools/publish/web_page.h"
#include "tools/say.h"
#include "voctree/files/clip.h"

namespace neuvv::tools {

namespace {

// A stream that is copied or encoded; performers that look the same show the same one.
struct ShownStream {
    uint32_t performer = 0;  // the first of them
    bool is_copied = false;
    render::LayerFolders layers;  // of paint, that are written into it
    std::string name;             // in the folder
};

bool has_shadows_on_performers(const stage::Stage& stage) {
    if (!stage.settings.falloff) return false;  // no light shines on them
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0);
    return std::ranges::any_of(render::light_statuses(stage, evaluated), &render::LightStatus::casts_shadow) &&
           std::ranges::any_of(evaluated.performers, [](const stage::EvaluatedPerformer& performer) {
               return performer.visible && performer.receives_shadow;
           });
}

std::string counted(size_t count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

class WebStage {
  public:
    explicit WebStage(const std::string& path);

    std::vector<std::string> files() const;  // that are written beside the player
    // The stage as it is in the folder.
    stage::GlbWriter document(const std::filesystem::path& folder) const;
    void write(const ExportOptions& options, const CommonOptions& common, const std::filesystem::path& to) const;
    const std::vector<std::string>& left_out() const { return left_out_; }
    std::string summary() const;

  private:
    void leave_out_of_stage();
    void add(uint32_t index);
    std::string name_of_stream(uint32_t index);
    std::string name_of_sound(const std::filesystem::path& sound);

    std::shared_ptr<const stage::Stage> stage_;
    stage::StageFile file_;  // edited
    std::vector<ShownStream> streams_;
    std::vector<std::pair<std::filesystem::path, std::string>> sounds_;  // and names in the folder
    std::vector<nlohmann::ordered_json> performers_;  // NEUVV_performer of each; null: hidden, and left out
    std::vector<std::string> left_out_;
};

WebStage::WebStage(const std::string& path)
    : stage_(std::make_shared<const stage::Stage>(stage::load_stage(path))), file_(stage_->file) {
    leave_out_of_stage();
    for (uint32_t i = 0; i < stage_->performers.size(); ++i) add(i);
    if (has_shadows_on_performers(*stage_)) left_out_.emplace_back("shadows on performers");
}

void WebStage::leave_out_of_stage() {
    edit::StageEdit edit;
    edit.duration_s = stage_->duration_s;  // also that of what is left out
    if (stage_->settings.environment) {
        left_out_.emplace_back("the environment");
        edit.environment = "";
    }
    if (stage_->settings.camera_path) {
        left_out_.emplace_back("the camera path");
        edit::set_camera_path(file_, std::nullopt);
    }
    edit::set_stage(file_, edit);
}

// Nothing that is hidden is published.
void WebStage::add(uint32_t index) {
    const stage::StagePerformer& performer = stage_->performers[index];
    nlohmann::ordered_json& json = performers_.emplace_back();
    if (!performer.settings.visible || !stage_->scene.nodes[performer.node].visible) {
        left_out_.push_back(fmt::format("\"{}\", which is hidden", performer.name));
        return;
    }
    stage::PerformerSettings settings = performer.settings;
    settings.uri = name_of_stream(index);
    settings.paint.clear();
    settings.skeleton_uri.clear();
    if (settings.sound) settings.sound->uri = name_of_sound(performer.sound);
    json = stage::json_of(settings);
    const bool is_mixed = std::ranges::any_of(performer.timeline.steps, [](const stage::Timeline::Step& step) {
        return step.verb == stage::TimeVerb::kSpeed && step.factor != 1;
    });
    if (is_mixed && !performer.timeline.hold)
        left_out_.push_back(fmt::format("mixtures of frames of \"{}\", whose speed is not 1", performer.name));
}

std::string WebStage::name_of_stream(uint32_t index) {
    const stage::StagePerformer& performer = stage_->performers[index];
    ShownStream stream{index, is_stream_to_copy(stage_->clips[performer.clip].path), visible_layers(*stage_, performer),
                       fmt::format("clip_{}.nvs", streams_.size() + 1)};
    if (stream.is_copied && !stream.layers.empty()) {
        left_out_.push_back(fmt::format("the paint of \"{}\", whose clip is a stream already", performer.name));
        stream.layers.clear();
    }
    for (const ShownStream& known : streams_)
        if (stage_->performers[known.performer].clip == performer.clip && known.layers == stream.layers)
            return known.name;
    streams_.push_back(stream);
    return stream.name;
}

std::string WebStage::name_of_sound(const std::filesystem::path& sound) {
    for (const auto& [known, name] : sounds_)
        if (known == sound) return name;
    const std::string ending = std::filesystem::path(split(sound.string(), '?')[0]).extension().string();
    sounds_.emplace_back(sound, fmt::format("sound_{}{}", sounds_.size() + 1, ending));
    return sounds_.back().second;
}

std::vector<std::string> WebStage::files() const {
    std::vector<std::string> names{kPageStage};
    for (const ShownStream& stream : streams_) names.push_back(stream.name);
    for (const auto& [sound, name] : sounds_) names.push_back(name);
    return names;
}

stage::GlbWriter WebStage::document(const std::filesystem::path& folder) const {
    stage::GlbWriter glb = stage::embedded(file_, folder / kPageStage);
    for (nlohmann::ordered_json& node : glb.json["nodes"])  // also of nodes that are in no scene
        if (node.contains("extensions")) node["extensions"].erase(stage::kPerformerExtension);
    for (size_t i = 0; i < performers_.size(); ++i) {
        nlohmann::ordered_json& extensions = glb.json["nodes"][stage_->performers[i].node]["extensions"];
        if (!performers_[i].is_null()) extensions[stage::kPerformerExtension] = performers_[i];
    }
    const auto images = glb.json.find("images");
    for (size_t i = 0; images != glb.json.end() && i < images->size(); ++i)
        if ((*images)[i].contains("uri"))  // which leads out of the folder
            throw InputError(stage_->file.path.string(), fmt::format("images/{}", i), "is neither PNG nor JPEG",
                             "convert it");
    return glb;
}

void WebStage::write(const ExportOptions& options, const CommonOptions& common, const std::filesystem::path& to) const {
    for (const ShownStream& stream : streams_) {
        if (stream.is_copied)
            copy_stream(stage_->clips[stage_->performers[stream.performer].clip].path, to / stream.name);
        else
            encode_scene(options.encoding, published_performer(stage_, stream.performer), common, to / stream.name);
    }
    for (const auto& [sound, name] : sounds_) copy_sound(sound, to / name);
}

std::string WebStage::summary() const {
    const auto shown = std::ranges::count_if(performers_, [](const auto& performer) { return !performer.is_null(); });
    return fmt::format("{} and {} of {}", counted(streams_.size(), "stream"), counted(sounds_.size(), "sound"),
                       counted(static_cast<size_t>(shown), "performer"));
}

}  // namespace

std::string write_web_stage(const ExportOptions& options, const CommonOptions& common, nlohmann::ordered_json& json) {
    const WebStage stage(options.scene);
    const std::filesystem::path folder = options.output;
    const UnfinishedWebPage page("--output", folder, find_stage_player(), stage.files());
    stage.document(folder).write(page.path() / kPageStage, "make the set smaller");
    stage.write(options, common, page.path());
    const std::string title = std::filesystem::path(options.scene).stem().string();
    if (const std::string note = page.finish(title); !note.empty()) say("{}\n", note);
    uint64_t bytes = 0;
    for (const std::string& name : page.files()) bytes += std::filesystem::file_size(folder / name);
    const std::string html = (folder / "index.html").string();
    json.update({{"files", page.files().size()}, {"bytes", bytes}, {"page", html}, {"left_out", stage.left_out()}});
    std::string text = stage.summary();
    for (const std::string& what : stage.left_out()) text += "\nleft out: " + what;
    return fmt::format("{}\n{} plays it from any file server that answers ranges: tools/serve {}", text, html,
                       options.output);
}

}  // namespace neuvv::tools
