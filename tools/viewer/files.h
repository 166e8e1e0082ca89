// Files of the viewer: what is open, what is saved, what is recovered, what was opened lately.
//
// The job queue does all reading and writing. What closes a document (opening another, quitting) asks first where there
// are unsaved edits; a copy of those goes to the recovery folder every kAutosaveInterval_s.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "editor/document_saver.h"
#include "tools/viewer/context.h"
#include "tools/viewer/exporter.h"
#include "tools/viewer/preferences.h"

namespace neuvv::viewer {

// What the user is asked: one at a time, each in a modal.
struct FileQuestion {
    enum class Kind { kUnsaved, kRecover, kPath } kind = Kind::kUnsaved;
    // kPath:
    std::string title;
    std::vector<std::string> endings;  // ".nvv"; of files that can be chosen
    bool to_save = false;
    std::filesystem::path folder;
    std::string name;  // typed
    std::function<void(const std::filesystem::path&)> then;
    // kRecover:
    std::vector<edit::RecoveryEntry> entries;
    // kUnsaved:
    std::function<void()> afterwards;
};

// What else changes when a file does.
struct FileEvents {
    std::function<void()> opened;  // another document is open now
    // The stage was saved under another name: layers that the file before it wears, too.
    std::function<void(std::set<std::filesystem::path>)> left_layers;
};

class Files {
  public:
    // `preferences`: the files that were opened lately are remembered there.
    Files(Context& context, Preferences& preferences, const Exporter& exporter, FileEvents events);

    // A stage, a clip, a folder of clips. Asks about unsaved edits, then whether to recover lost ones.
    void open(const std::filesystem::path& path);
    // Asks which one.
    void ask_to_open();
    void new_stage();
    // At a start without a file: edits of any stage that a process left behind are offered, the latest first.
    void offer_lost();
    // Where it has a file, else asks for one.
    void save();
    void save_as();
    // Dropped on the window: a stage is opened; clips, paint and images go onto the stage that is open.
    void take(const std::filesystem::path& dropped);

    // Asks for a path, then calls `then` on the window's thread. `to_save`: it need not exist; where it does,
    // overwriting is confirmed.
    void ask_path(std::string title, std::vector<std::string> endings, bool to_save, const std::string& name,
                  std::function<void(const std::filesystem::path&)> then);
    // Now where nothing would be lost, else after the user has decided; never, where the user cancels.
    void when_saved_or_given_up(std::function<void()> then);

    // Each frame: stores unsaved edits for recovery, looks whether clips were written anew.
    void tick();
    // Draws what is asked.
    void panel();

  private:
    void open_now(const std::filesystem::path& path);
    void read(const std::filesystem::path& path);
    void opened(edit::Document document, bool modified, std::optional<edit::RecoveryEntry> from = {});
    void recover(const edit::RecoveryEntry& entry);
    // `then` is called with `path` unless they are recovered.
    void ask_to_recover(std::vector<edit::RecoveryEntry> entries, const std::filesystem::path& path,
                        std::function<void(const std::filesystem::path&)> then);
    void save_to(const std::filesystem::path& path, std::function<void()> then);
    bool refused_by_export();
    void watch_clips();
    void path_panel();
    void unsaved_panel();
    void recover_panel();
    void close_question();

    void list_folder(const std::filesystem::path& folder);
    void choose(const std::filesystem::path& path);

    Context& context_;
    Preferences& preferences_;
    const Exporter& exporter_;
    FileEvents events_;
    struct Listed {
        std::string name;
        bool folder = false;
    };
    std::vector<Listed> listed_;       // of the question's folder
    std::filesystem::path confirmed_;  // the user was told that this file will be replaced
    std::optional<FileQuestion> question_;
    editor::DocumentSaver saver_;
    double watched_s_ = 0;
    std::vector<std::pair<std::filesystem::path, std::filesystem::file_time_type>> clips_;
};

}  // namespace neuvv::viewer
