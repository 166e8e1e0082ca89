#include "tools/publish/web_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "tools/html.h"
#include "tools/results.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::tools {

namespace {

// A list names the files of a folder, so that neither what else lies there is taken for one of them, nor a part for the
// whole.
constexpr const char* kPlayerList = "player.json";
constexpr const char* kPlayerWrittenBy = "tools/web/build";
constexpr const char* kPageList = "published.json";
constexpr const char* kPageWrittenBy = "neuvv publish";
constexpr const char* kPage = "index.html";

std::vector<std::string> listed_files(const std::filesystem::path& list, const char* written_by) {
    const JsonFile json = read_json(list, "a list of files");
    const JsonNode root = json.root(), writer = root["written_by"], names = root["files"];
    if (json_string(writer) != written_by) writer.fail(fmt::format("is not \"{}\"", written_by));
    expect_list(names);
    std::vector<std::string> files;
    for (size_t i = 0; i < names.value.size(); ++i) {
        const std::string name = json_string(names[i]);
        // No path, which might lead out of the folder.
        if (name.empty() || name == "." || name == ".." || std::filesystem::path(name).filename() != name)
            names[i].fail("is no name of a file");
        files.push_back(name);
    }
    return files;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

// The player's page with another title. Where there is no sound, the player is told so, and does not ask for one.
std::string page_of(const WebPlayer& player, const std::string& title, bool has_sound) {
    constexpr std::string_view kBefore = "<title>", kAfter = "</title>", kElement = "<neuvv-player";
    std::string page = player.page;
    const size_t before = page.find(kBefore), end = page.find(kAfter, before);
    if (before == std::string::npos || end == std::string::npos)
        throw InputError((player.folder / kPage).string(), "", "has no title", "run tools/web/build");
    const size_t begin = before + kBefore.size();
    page.replace(begin, end - begin, html_text(title));
    const size_t element = page.find(kElement);
    if (!has_sound && element != std::string::npos) page.insert(element + kElement.size(), " sound=\"\"");
    return page;
}

// A folder without the list of an earlier page must be empty, but for what a run that was killed left there. Beside an
// earlier page, other files may lie, which stay.
std::vector<std::string> files_of_earlier_page(const std::filesystem::path& folder) {
    std::error_code error;
    bool empty = true;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        empty = empty && entry.path().filename() == "unfinished";
    if (empty) return {};
    if (!std::filesystem::exists(folder / kPageList, error))
        throw InputError("--web", folder.string(), "holds other files than a published page",
                         "choose an empty folder or a new one");
    expect_replaceable("--web", folder);
    return listed_files(folder / kPageList, kPageWrittenBy);
}

}  // namespace

WebPlayer find_web_player() {
    WebPlayer player{(program_file().parent_path() / "../web").lexically_normal(), {}, {}};
    std::error_code error;
    if (!std::filesystem::exists(player.folder / kPlayerList, error))
        throw InputError(player.folder.string(), "", "the player for browsers is not there", "run tools/web/build");
    player.files = listed_files(player.folder / kPlayerList, kPlayerWrittenBy);
    if (!contains(player.files, kPage)) player.files.emplace_back(kPage);
    for (const std::string& name : player.files)
        if (!std::filesystem::is_regular_file(player.folder / name, error))
            throw InputError(player.folder.string(), "", fmt::format("{} of the player is not there", name),
                             "run tools/web/build");
    const std::vector<uint8_t> page = read_file(player.folder / kPage);
    player.page.assign(page.begin(), page.end());
    page_of(player, "", true);  // throws where that cannot be done
    return player;
}

UnfinishedWebPage::UnfinishedWebPage(std::filesystem::path folder, WebPlayer player, bool has_sound)
    : folder_(std::move(folder)), player_(std::move(player)), has_sound_(has_sound), names_(player_.files) {
    names_.insert(names_.end(), {kPageList, kPageStream});
    if (has_sound_) names_.push_back(voctree::sound_file(kPageStream).string());
    prepare_output_folder("--web", folder_);
    replaced_ = files_of_earlier_page(folder_);
    std::error_code error;
    for (const std::string& name : names_)
        if (!contains(replaced_, name) && std::filesystem::exists(folder_ / name, error))
            throw InputError("--web", (folder_ / name).string(), "is not of the page that was published there",
                             "move it elsewhere");
    prepare_results("--web", folder_, replaced_);
    prepare_results("--web", folder_, names_);
    files_.emplace(folder_);
}

void UnfinishedWebPage::finish(const std::string& title) const {
    try {
        for (const std::string& name : player_.files)
            if (name != kPage) std::filesystem::copy_file(player_.folder / name, files_->path() / name);
        write_text_file(files_->path() / kPageList, json_text({{"written_by", kPageWrittenBy}, {"files", names_}}));
        // While there is no page, nothing looks finished; while there is a list, --overwrite may replace what is there.
        std::filesystem::remove(folder_ / kPage);
        for (const std::string& name : replaced_)
            if (name != kPageList) std::filesystem::remove(folder_ / name);
        std::filesystem::rename(files_->path() / kPageList, folder_ / kPageList);
    } catch (const std::filesystem::filesystem_error& error) {
        throw RuntimeFailure(fmt::format("{}: cannot be written: {}", folder_.string(), error.code().message()));
    }
    files_->finish();
    write_text_file(folder_ / kPage, page_of(player_, title, has_sound_));
}

}  // namespace neuvv::tools
