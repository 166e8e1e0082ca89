#include "tools/viewer/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/platform.h"
#include "edit/operations.h"
#include "edit/paint_layers.h"
#include "editor/open_file.h"
#include "interchange/camera/camera_path_file.h"
#include "tools/viewer/context.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_index.h"

namespace neuvv::viewer {

bool is_plain_folder(const std::filesystem::path& path) {
    std::error_code error;
    return std::filesystem::is_directory(path, error) && !voctree::is_segmented(path);
}

namespace {

constexpr double kWatchInterval_s = 1;

constexpr const char* kReadableFiles =
    "a stage (.gltf, .glb), splats (.ply), volumes (.vdb), paint (.nvpaint), an image (.png), a sound (.wav, .flac, "
    ".ogg, .opus, .mp3, .m4a), a motion (.bvh, .trc), a skeleton (.skeleton.glb), a camera path (.json, .usda), a "
    "folder with clips or a data set";

bool is_one_of(const std::filesystem::path& path, std::initializer_list<const char*> endings) {
    std::string ending = path.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::any_of(endings.begin(), endings.end(), [&](const char* e) { return ending == e; });
}

bool is_skeleton(const std::filesystem::path& path) {
    return is_one_of(path, {".glb"}) && is_one_of(path.stem(), {".skeleton"});
}

bool has_clips(const std::filesystem::path& folder) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (entry.path().extension() == ".nvv") return true;
    return false;
}

}  // namespace

Files::Files(Context& context, Preferences& preferences, const Exporter& exporter, FileEvents events)
    : context_(context),
      preferences_(preferences),
      exporter_(exporter),
      events_(std::move(events)),
      saver_(context.editor, context.jobs) {}

// All images of an export show the same stage, so no other may be opened meanwhile.
bool Files::refused_by_export() {
    if (!exporter_.job()) return false;
    context_.editor.notify("an export goes on: cancel it first", true);
    return true;
}

void Files::open(const std::filesystem::path& path) {
    when_saved_or_discarded([this, path] { open_now(path); });
}

// Edits that a crash left behind are offered before the stage is read.
void Files::open_now(const std::filesystem::path& path) {
    context_.jobs.start(fmt::format("Opening {}", path.filename().string()), [this, path] {
        const std::vector<edit::RecoveryEntry> entries = editor::lost_edits_of(editor::stage_of_file(path));
        return [this, path, entries] {
            if (entries.empty() || question_) return read(path);
            ask_to_recover(entries, path, [this](const std::filesystem::path& of) { read(of); });
        };
    });
}

void Files::offer_recovery() {
    context_.jobs.start("", [this]() -> JobQueue::Then {
        const std::vector<edit::RecoveryEntry> entries = editor::lost_edits();
        if (entries.empty()) return {};
        return [this, entries] {
            if (!question_ && !context_.editor.is_open()) ask_to_recover(entries, {}, [](const auto&) {});
        };
    });
}

void Files::ask_to_recover(std::vector<edit::RecoveryEntry> entries, const std::filesystem::path& path,
                           std::function<void(const std::filesystem::path&)> then) {
    question_ = FileQuestion{};
    question_->kind = FileQuestion::Kind::kRecover;
    question_->entries = std::move(entries);
    question_->then = std::move(then);
    question_->folder = path;
    context_.redraw();
}

void Files::read(const std::filesystem::path& path) {
    context_.jobs.start(fmt::format("Opening {}", path.filename().string()), [this, path, id = context_.editor.id()] {
        auto document = std::make_shared<edit::Document>(editor::open_document(path, editor::AroundClip::kLitFloor));
        return [this, document, path, id] {
            // Edits that were made while the file was read are asked about again.
            if (context_.editor.modified() && context_.editor.id() != id) return open(path);
            const bool is_clip = !editor::has_stage_ending(path);
            opened(std::move(*document), {.clip = is_clip ? path.filename().string() : ""});
            remember_file(preferences_, path);
        };
    });
}

void Files::recover(const edit::RecoveryEntry& entry) {
    context_.jobs.start(fmt::format("Recovering {}", entry.stage.filename().string()), [this, entry] {
        auto document = std::make_shared<edit::Document>(edit::restore(entry));
        return [this, document, entry] {
            opened(std::move(*document), {.modified = true, .from = entry});
            context_.editor.notify("recovered unsaved edits; save to keep them");
        };
    });
}

void Files::opened(edit::Document document, Opened what) {
    saver_.autosave.opened(std::move(what.from));
    events_.opened();
    clips_.clear();
    clip_ = std::move(what.clip);
    context_.editor.open(std::move(document), what.modified);
    context_.redraw();
}

std::string Files::name() const {
    const stage::StageFile& file = context_.editor.file();
    return clip_.empty() || file.saved->on_disk ? file.path.filename().string() : clip_;
}

void Files::ask_to_open() {
    std::vector<std::string> endings{".gltf", ".glb", ".ply", ".vdb", ".bvh", ".trc", ".json", ".usda"};
    std::ranges::copy(voctree::kClipEndings, std::back_inserter(endings));
    ask_path("Open", endings, false, "", [this](const std::filesystem::path& path) {
        voctree::has_clip_ending(path) ? open(path) : open_or_add(path);
    });
}

void Files::new_stage() {
    when_saved_or_discarded([this] {
        const std::filesystem::path path = stage::absolute_path("stage.gltf");
        opened({neuvv::edit::new_stage(path), {}, {}}, {.modified = true});
    });
}

void Files::save() {
    if (!context_.editor.is_open()) return;
    if (context_.editor.file().saved->on_disk)
        save_to(context_.editor.file().path, {});
    else
        save_as();
}

void Files::save_as() {
    if (!context_.editor.is_open()) return;
    const bool binary = context_.editor.file().saved->binary;
    ask_path("Save stage as", {binary ? ".glb" : ".gltf"}, true, context_.editor.file().path.filename().string(),
             [this](const std::filesystem::path& path) { save_to(path, {}); });
}

void Files::save_to(const std::filesystem::path& path, const std::function<void()>& then) {
    const stage::StageFile& file = context_.editor.file();
    const bool moves = file.saved->on_disk && stage::absolute_path(path) != stage::absolute_path(file.path);
    saver_.save(path, [this, path, moves, then](const edit::Document& saved, uint64_t open_count) {
        if (moves && open_count == context_.editor.open_count()) events_.saved_elsewhere(edit::used_layers(saved.file));
        remember_file(preferences_, path);
        if (then) then();
    });
}

// Adds what belongs on the open stage. Returns whether the file is of such a kind.
bool Files::add_to_stage(const std::filesystem::path& file) {
    editor::Editor& editor = context_.editor;
    if (voctree::has_clip_ending(file)) {
        edit::PerformerEdit performer;
        performer.clip = file;
        editor.edit(
            [&](edit::Document& d) { return edit::add_performer(d.file, file.stem().string(), performer, {}); });
    } else if (is_one_of(file, {".nvpaint"})) {
        if (!editor.selected()) {
            editor.notify("select the performer that shall wear this paint first", true);
            return true;
        }
        editor.edit([&](edit::Document& d) { return edit::add_paint_layer(d.file, *editor.selected(), file, {}); });
    } else if (is_one_of(file, {".png"})) {
        edit::StageEdit stage;
        stage.environment = file;
        editor.edit([&](edit::Document& d) { return edit::set_stage(d.file, stage); });
    } else if (is_one_of(file, {".wav", ".flac", ".ogg", ".opus", ".mp3", ".m4a"})) {
        if (!editor.selected()) {
            editor.notify("select the performer that shall be heard by this sound first", true);
            return true;
        }
        edit::PerformerEdit performer;
        performer.sound = file;
        editor.edit([&](edit::Document& d) { return edit::set_performer(d.file, *editor.selected(), performer); });
    } else if (is_one_of(file, {".json", ".usda"})) {
        add_camera_path(file);
    } else {
        return false;
    }
    return true;
}

void Files::add_skeleton(const std::filesystem::path& file) {
    editor::Editor& editor = context_.editor;
    if (!editor.selected() || !edit::performer_on(editor.file(), *editor.selected())) return events_.motion_given(file);
    edit::PerformerEdit performer;
    performer.skeleton = file;
    editor.edit([&](edit::Document& d) { return edit::set_performer(d.file, *editor.selected(), performer); });
}

void Files::add_camera_path(const std::filesystem::path& file) {
    context_.jobs.start(
        fmt::format("Reading {}", file.filename().string()),
        [this, file, of = context_.editor.file(), open_count = context_.editor.open_count()] {
            const stage::Stage stage = stage::make_stage(of);
            const stage::CameraPath path = interchange::read_camera_path(file, stage.fps, interchange::frame_of(stage));
            return [this, path, open_count] {
                if (context_.editor.open_count() != open_count) return;
                context_.editor.edit([&](edit::Document& d) { return edit::set_camera_path(d.file, path); });
            };
        });
}

void Files::open_or_add(const std::filesystem::path& file) {
    if (is_plain_folder(file)) return has_clips(file) ? open(file) : events_.verb_wanted("train", file);
    if (is_one_of(file, {".ply", ".vdb"})) return events_.verb_wanted("import", file);
    if (is_one_of(file, {".bvh", ".trc"})) return events_.motion_given(file);
    const bool is_open = context_.editor.is_open();
    if (is_open && is_skeleton(file)) return add_skeleton(file);
    if (editor::has_stage_ending(file) || (!is_open && voctree::has_clip_ending(file))) return open(file);
    if (is_open && add_to_stage(file)) return;
    context_.editor.notify(is_open ? fmt::format("{}: is none of a clip ({}), {}", file.filename().string(),
                                                 voctree::clip_endings_text(), kReadableFiles)
                                   : fmt::format("{}: open a stage or a clip first", file.filename().string()),
                           true);
}

void Files::ask_path(std::string title, std::vector<std::string> endings, bool to_save, const std::string& name,
                     std::function<void(const std::filesystem::path&)> then) {
    if (question_) return;
    question_ = FileQuestion{};
    question_->kind = FileQuestion::Kind::kPath;
    question_->title = std::move(title);
    question_->endings = std::move(endings);
    question_->to_save = to_save;
    question_->name = name;
    question_->then = std::move(then);
    list_folder(context_.editor.is_open() ? context_.editor.file().path.parent_path() : ".");
}

void Files::list_folder(const std::filesystem::path& folder) {
    question_->folder = stage::absolute_path(folder.empty() ? "." : folder);
    context_.jobs.start("", [this, of = question_->folder, endings = question_->endings] {
        std::vector<ListedFile> listed;
        std::error_code error;
        for (const auto& entry : std::filesystem::directory_iterator(of, error)) {
            const std::string name = entry.path().filename().string();
            const bool is_folder = is_plain_folder(entry.path());
            const std::string ending = entry.path().extension().string();
            const bool fits =
                is_folder || (!ending.empty() && std::find(endings.begin(), endings.end(), ending) != endings.end());
            if (!name.starts_with('.') && fits) listed.push_back({name, is_folder});
        }
        std::sort(listed.begin(), listed.end(), [](const ListedFile& a, const ListedFile& b) {
            return std::pair(!a.folder, a.name) < std::pair(!b.folder, b.name);
        });
        return [this, of, listed] {
            if (question_ && question_->folder == of) listed_ = listed;
            context_.redraw();
        };
    });
}

void Files::when_saved_or_discarded(std::function<void()> then) {
    if (question_ || refused_by_export()) return;
    context_.editor.end_drag();
    if (!context_.editor.modified()) {
        saver_.autosave.forget();
        return then();
    }
    question_ = FileQuestion{};
    question_->afterwards = std::move(then);
    context_.redraw();
}

void Files::ask_to_stop(std::string title, std::function<void()> then) {
    if (question_) return;
    question_ = FileQuestion{};
    question_->kind = FileQuestion::Kind::kStop;
    question_->title = std::move(title);
    question_->afterwards = std::move(then);
    context_.redraw();
}

void Files::close_question() {
    question_.reset();
    confirmed_.clear();
    listed_.clear();
}

void Files::tick() {
    saver_.autosave.tick(context_.frame.now_s);
    if (context_.frame.now_s - watched_s_ >= kWatchInterval_s) watch_clips();
}

// A training run writes its clip again with each checkpoint.
void Files::watch_clips() {
    if (!context_.frame.stage || !context_.jobs.idle() || exporter_.job()) return;
    watched_s_ = context_.frame.now_s;
    std::vector<std::filesystem::path> paths;
    for (const stage::StageClip& clip : context_.frame.stage->clips) paths.push_back(clip.path);
    context_.jobs.start("", [this, paths, before = clips_]() -> JobQueue::Then {
        auto now = before;
        now.clear();
        for (const std::filesystem::path& path : paths) {
            std::error_code error;
            now.emplace_back(path, std::filesystem::last_write_time(path, error));
        }
        if (now == before) return {};
        return [this, now, first = before.empty()] {
            clips_ = now;
            if (!first) context_.requests.reload_document = true;
        };
    });
}

}  // namespace neuvv::viewer
