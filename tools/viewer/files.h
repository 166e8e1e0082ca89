// The files of the viewer: opening, saving, recovery of unsaved edits, and the list of files that were opened recently.
//
// The job queue reads and writes all files. Before the document is closed, by opening another or by quitting, the user
// is asked about unsaved edits. A copy of unsaved edits is stored for recovery every kAutosaveInterval_s
// (editor/autosave.h).
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

// A question to the user, in a modal dialog. One is asked at a time.
struct FileQuestion {
    enum class Kind { kUnsaved, kRecover, kPath, kStop } kind = Kind::kUnsaved;
    std::string title;  // of kPath and kStop
    // kPath:
    std::vector<std::string> endings;  // of the files that can be selected, as ".nvv"; "" alone: a folder
    bool to_save = false;              // the path is for writing a file, else for reading one
    bool wants_folder() const { return endings == std::vector<std::string>{""}; }
    std::filesystem::path folder;  // the folder that is listed; of kRecover: the path that was to be opened
    std::string name;              // of the file, as typed or selected
    // kPath: called with the path that the user gave. kRecover: called with `folder` unless edits are recovered.
    std::function<void(const std::filesystem::path&)> then;
    // kRecover; the first entry is the one that is offered:
    std::vector<edit::RecoveryEntry> entries;
    // kUnsaved: called once the edits are saved or discarded. kStop: once the user has agreed.
    std::function<void()> afterwards;
};

// Functions that Files calls when the open document or its file has changed.
struct FileEvents {
    std::function<void()> opened;  // another document is being opened
    // The stage was saved under another name. The argument: the layers of paint that the stage under its earlier name
    // still uses, too.
    std::function<void(std::set<std::filesystem::path>)> saved_elsewhere;
    // A file was given that a verb of `neuvv` makes a clip of: the verb and the file.
    std::function<void(const std::string&, const std::filesystem::path&)> verb_wanted;
    // A recorded motion was given, to be compared with a performer's.
    std::function<void(const std::filesystem::path&)> motion_given;
};

// Whether the path is a folder, but no segmented clip: such a clip is chosen and opened as a file is.
bool is_plain_folder(const std::filesystem::path& path);

class Files {
  public:
    // `preferences` gets the list of files that were opened recently. All references must outlive this object.
    Files(Context& context, Preferences& preferences, const Exporter& exporter, FileEvents events);

    // Opens a stage, a clip or the newest clip of a folder. Asks about unsaved edits of the open document first, then
    // whether to recover edits of this stage that a crash left behind.
    void open(const std::filesystem::path& path);
    // Asks for a path, then opens it.
    void ask_to_open();
    void new_stage();
    // What the open document is called: its file's name, or that of the clip that was opened, where there is no file.
    std::string name() const;
    // For a start without a file: offers to recover the edits that a crash left behind, those of the stage that was
    // edited last.
    void offer_recovery();
    // Saves the document to its file, or asks for a path where it has no file yet.
    void save();
    void save_as();
    // For a file that was dropped on the window: opens a stage, or a folder with clips; adds a clip, a layer of paint,
    // an environment, a sound or a camera path to the open stage; without an open stage, a clip is opened. Splats,
    // volumes and folders of data sets open the dialog that makes a clip of them; a recorded motion is compared with a
    // performer's. A skeleton (.skeleton.glb) becomes that of the selected performer; while none is selected, it is
    // such a motion.
    void open_or_add(const std::filesystem::path& file);

    // Asks for a path and calls `then` with it on the window's thread, unless the user cancels. Does nothing while
    // another question is open. With `to_save` the file need not exist; the user confirms to replace one that does.
    void ask_path(std::string title, std::vector<std::string> endings, bool to_save, const std::string& name,
                  std::function<void(const std::filesystem::path&)> then);
    // Calls `then`: at once where there are no unsaved edits, else once the user has saved or discarded them. Does not
    // call it where the user cancels, while another question is open, or while an export is under way.
    void when_saved_or_discarded(std::function<void()> then);

    // Asks whether what runs, which `title` names, may be stopped, and calls `then` if so. Does nothing while another
    // question is open.
    void ask_to_stop(std::string title, std::function<void()> then);

    // To be called once a frame. Stores unsaved edits for recovery, and reads clips again whose files have changed.
    void tick();
    // For an error that ends the program, after the job queue was stopped: stores unsaved edits for recovery at once.
    void keep_unsaved_edits() { saver_.autosave.store_now(); }
    // Draws the open question, and acts on its answer.
    void panel();

  private:
    void open_now(const std::filesystem::path& path);
    void read(const std::filesystem::path& path);
    struct Opened {
        bool modified = false;
        std::optional<edit::RecoveryEntry> from = {};
        std::string clip = {};  // the name of the clip that the document was made for
    };
    void opened(edit::Document document, Opened what);
    void recover(const edit::RecoveryEntry& entry);
    // Calls `then` with `path` once the user has declined.
    void ask_to_recover(std::vector<edit::RecoveryEntry> entries, const std::filesystem::path& path,
                        std::function<void(const std::filesystem::path&)> then);
    void save_to(const std::filesystem::path& path, const std::function<void()>& then);
    bool refused_by_export();
    void watch_clips();
    bool add_to_stage(const std::filesystem::path& file);
    void add_skeleton(const std::filesystem::path& file);
    void add_camera_path(const std::filesystem::path& file);
    void path_panel();
    void unsaved_panel();
    void recover_panel();
    void stop_panel();
    void close_question();

    void list_folder(const std::filesystem::path& folder);
    void choose_folder();
    void choose(const std::filesystem::path& path);

    Context& context_;
    Preferences& preferences_;
    const Exporter& exporter_;
    FileEvents events_;
    struct ListedFile {
        std::string name;
        bool folder = false;
    };
    std::vector<ListedFile> listed_;   // the contents of the question's folder
    std::filesystem::path confirmed_;  // the user has been told that saving again replaces this file
    std::optional<FileQuestion> question_;
    std::string clip_;  // as Opened::clip, of the open document
    editor::DocumentSaver saver_;
    double watched_s_ = 0;  // when the clips' files were looked at last
    std::vector<std::pair<std::filesystem::path, std::filesystem::file_time_type>> clips_;
};

}  // namespace neuvv::viewer
