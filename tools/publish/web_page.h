// What `neuvv publish --web` and `neuvv export --as web` write: a folder with the player for browsers, what it plays,
// and a page; or a page alone that has all of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/unfinished_folder.h"

namespace neuvv::tools {

// The names of the stream, or of the stage, in the folder. The page's script plays it.
inline constexpr const char* kPageStream = "show.nvs";
inline constexpr const char* kPageStage = "show.glb";

// The player, as tools/web/build left it.
struct WebPlayer {
    std::filesystem::path folder;
    std::vector<std::string> files;  // names of all of them in the folder, and of index.html
    std::string page;                // the HTML of index.html
};

// Looks in `web` beside the folder of this program: build/web for build/release/neuvv. Throws InputError where the
// player is not there, or not whole.
WebPlayer find_web_player();
// The same with three.js, for stages.
WebPlayer find_stage_player();
// The same as a page alone.
WebPlayer find_one_file_player();

// Writes a page that has a stream and its sound, if it has one, in it. Throws InputError where it would have more than
// kMostOneFileBytes: a browser reads it as a whole.
inline constexpr uint64_t kMostOneFileBytes = 20'000'000;
void write_one_file_page(const std::filesystem::path& output, const WebPlayer& player, const std::string& title,
                         const std::filesystem::path& stream, const std::optional<std::filesystem::path>& sound);

class UnfinishedWebPage {
  public:
    // `own`: names of the files that are to be written into path(), of which the player makes a page. Throws InputError
    // where the folder holds files, but no such page; where it holds one, unless --overwrite says that it is replaced;
    // and where a file would be replaced that the verb reads or that is not of that page. `option` names the folder.
    UnfinishedWebPage(std::string option, std::filesystem::path folder, WebPlayer player,
                      const std::vector<std::string>& own);

    std::filesystem::path path() const { return files_->path(); }
    // Removes an earlier page, and moves this one into its place, the page itself last. An earlier index.html that is
    // not as it was written stays. Returns a line that says so, or nothing. Throws RuntimeFailure.
    [[nodiscard]] std::string finish(const std::string& title) const;
    // Names in the folder.
    const std::vector<std::string>& files() const { return names_; }

  private:
    // Whether somebody has changed the index.html that is there.
    bool is_edited() const;

    std::string option_;
    std::filesystem::path folder_;
    WebPlayer player_;
    std::vector<std::string> names_;        // of all files that are written
    std::vector<std::string> replaced_;     // of those of the earlier page
    std::string earlier_html_;              // of its index.html, as it was written; empty where that is not known
    std::optional<UnfinishedFiles> files_;  // once it is known that the folder may be written
};

}  // namespace neuvv::tools
