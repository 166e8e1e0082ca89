// What `neuvv publish --web` writes: a folder with the player for browsers, a stream, its sound, and a page that plays
// them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/unfinished_folder.h"

namespace neuvv::tools {

// The name of the stream in the folder. The page's script plays it.
inline constexpr const char* kPageStream = "show.nvs";

// The player, as tools/web/build left it.
struct WebPlayer {
    std::filesystem::path folder;
    std::vector<std::string> files;  // names of all of them in the folder
    std::string page;                // the HTML of one of them, index.html
};

// Looks in `web` beside the folder of this program: build/web for build/release/neuvv. Throws InputError where the
// player is not there, or not whole.
WebPlayer find_web_player();

class UnfinishedWebPage {
  public:
    // Throws InputError where the folder holds files, but no such page; where it holds one, unless --overwrite says
    // that it is replaced; and where a file would be replaced that the verb reads or that is not of that page.
    UnfinishedWebPage(std::filesystem::path folder, WebPlayer player, bool has_sound);

    // Where the stream is to be written, and beside it the sound, if it has one.
    std::filesystem::path stream() const { return files_->path() / kPageStream; }
    // Removes an earlier page, and moves this one into its place, the page itself last. Throws RuntimeFailure.
    void finish(const std::string& title) const;

  private:
    std::filesystem::path folder_;
    WebPlayer player_;
    bool has_sound_;
    std::vector<std::string> names_;        // of all files that are written
    std::vector<std::string> replaced_;     // of those of the earlier page
    std::optional<UnfinishedFiles> files_;  // once it is known that the folder may be written
};

}  // namespace neuvv::tools
