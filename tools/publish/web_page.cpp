#include "tools/publish/web_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/text.h"
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
constexpr const char* kPageHtml = "index_html";  // member of the list: the page as it was written
constexpr const char* kPage = "index.html";
constexpr const char *kPageOfStages = "stage.html", *kPageOfOneFile = "one_file.html";  // in the player's folder

// Whether a name is one of a file in the folder or in a folder of it, and leads nowhere else.
bool is_file_in(const std::filesystem::path& folder, const std::filesystem::path& name) {
    std::error_code error;
    const std::filesystem::path file = std::filesystem::weakly_canonical(folder, error) / name;
    return name.is_relative() && name.has_filename() && file == file.lexically_normal() &&
           std::filesystem::weakly_canonical((folder / name).parent_path(), error) == file.parent_path();
}

std::vector<std::string> listed_files(const JsonNode& names, const std::filesystem::path& folder) {
    expect_list(names);
    std::vector<std::string> files;
    for (size_t i = 0; i < names.value.size(); ++i) {
        files.push_back(json_string(names[i]));
        if (!is_file_in(folder, files.back())) names[i].fail("is no name of a file in this folder");
    }
    return files;
}

JsonFile read_list(const std::filesystem::path& list, const char* written_by) {
    JsonFile json = read_json(list, "a list of files");
    const JsonNode root = json.root(), writer = root["written_by"];
    if (json_string(writer) != written_by) writer.fail(fmt::format("is not \"{}\"", written_by));
    return json;
}

uint64_t base64_size(uint64_t bytes) {
    return (bytes + 2) / 3 * 4;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

// The page with another title. Where there is no sound, an element that plays one stream is told so, and does not ask
// for one.
std::string page_of(const WebPlayer& player, const std::string& title, bool has_sound) {
    constexpr std::string_view kBefore = "<title>", kAfter = "</title>", kElement = "<neuvv-player";
    std::string page = player.page;
    const size_t before = page.find(kBefore), end = page.find(kAfter, before);
    if (before == std::string::npos || end == std::string::npos)
        throw InputError(player.folder.string(), "", "its page has no title", "run tools/web/build");
    const size_t begin = before + kBefore.size();
    page.replace(begin, end - begin, html_text(title));
    const size_t element = page.find(kElement);
    if (!has_sound && element != std::string::npos) page.insert(element + kElement.size(), " sound=\"\"");
    return page;
}

// Who names a page or another file does not want a folder of that name.
void expect_folder_name(const std::string& option, const std::filesystem::path& folder) {
    std::string ending = folder.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* other : {".html", ".htm", ".json", ".gltf", ".glb", ".nvs", ".nvv", ".zip", ".mp4"})
        if (ending == other)
            throw InputError(option, folder.string(), "has a file's name, and a folder is written",
                             "leave the ending out; one file: neuvv publish CLIP --web NAME.html");
}

std::string text_of(const std::filesystem::path& file) {
    const std::vector<uint8_t> bytes = read_file(file);
    return {bytes.begin(), bytes.end()};
}

struct EarlierPage {
    std::vector<std::string> files;
    std::string html;  // of index.html, as it was written
};

// A folder without the list of an earlier page must be empty, but for what a run that was killed left there. Beside an
// earlier page, other files may lie, which stay.
EarlierPage earlier_page(const std::string& option, const std::filesystem::path& folder) {
    std::error_code error;
    bool empty = true;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        empty = empty && entry.path().filename() == "unfinished";
    if (empty) return {};
    if (!std::filesystem::exists(folder / kPageList, error))
        throw InputError(option, folder.string(), "holds other files than a published page",
                         "choose an empty folder or a new one");
    expect_replaceable(option, folder);
    const JsonFile list = read_list(folder / kPageList, kPageWrittenBy);
    return {listed_files(list.root()["files"], folder),
            list.document.contains(kPageHtml) ? json_string(list.root()[kPageHtml]) : ""};
}

// The player whose page has this name. Whether the program can make a page of it is seen before any work.
WebPlayer find_player(const std::string& page_name) {
    WebPlayer player{(program_file().parent_path() / "../web").lexically_normal(), {}, {}};
    std::error_code error;
    if (!std::filesystem::exists(player.folder / kPlayerList, error))
        throw InputError(player.folder.string(), "", "the player for browsers is not there", "run tools/web/build");
    const JsonFile list = read_list(player.folder / kPlayerList, kPlayerWrittenBy);
    player.files = listed_files(list.root()["files"], player.folder);
    if (page_name == kPageOfStages) {
        if (!list.document.contains("stage_files"))
            throw InputError(
                player.folder.string(), "", "has no three.js, by which stages are played",
                fmt::format("run npm install three && tools/web/build {} node_modules/three", player.folder.string()));
        for (std::string& name : listed_files(list.root()["stage_files"], player.folder))
            player.files.push_back(std::move(name));
    }
    if (page_name == kPageOfOneFile && !std::filesystem::exists(player.folder / page_name, error))
        throw InputError(player.folder.string(), "", "has no page of one file, which esbuild makes",
                         "run tools/install-packages web && tools/web/build");
    if (!contains(player.files, page_name)) player.files.emplace_back(page_name);
    for (const std::string& name : player.files)
        if (!std::filesystem::is_regular_file(player.folder / name, error))
            throw InputError(player.folder.string(), "", fmt::format("{} of the player is not there", name),
                             "run tools/web/build");
    player.page = text_of(player.folder / page_name);
    page_of(player, "", true);
    std::erase(player.files, page_name);
    if (!contains(player.files, kPage)) player.files.emplace_back(kPage);
    return player;
}

}  // namespace

WebPlayer find_web_player() {
    return find_player(kPage);
}

WebPlayer find_stage_player() {
    return find_player(kPageOfStages);
}

WebPlayer find_one_file_player() {
    return find_player(kPageOfOneFile);
}

void write_one_file_page(const std::filesystem::path& output, const WebPlayer& player, const std::string& title,
                         const std::filesystem::path& stream, const std::optional<std::filesystem::path>& sound) {
    std::string page = page_of(player, title, true);
    uint64_t bytes = page.size() + base64_size(std::filesystem::file_size(stream));
    if (sound) bytes += base64_size(std::filesystem::file_size(*sound));
    if (bytes > kMostOneFileBytes)
        throw InputError("--web", output.string(),
                         fmt::format("would have {:.1f} MB; a page of one file has at most {:.0f}",
                                     1e-6 * static_cast<double>(bytes), 1e-6 * static_cast<double>(kMostOneFileBytes)),
                         "encode the clip with a lower --rate or --quality, or choose a folder");
    const auto put = [&](const char* id, const std::filesystem::path& file) {
        const std::string element = fmt::format("id=\"{}\">", id);
        const size_t place = page.find(element);
        if (place == std::string::npos)
            throw InputError(player.folder.string(), "", fmt::format("its page has no {}", id), "run tools/web/build");
        page.insert(place + element.size(), base64(read_file(file)));
    };
    put("stream", stream);
    if (sound) put("sound", *sound);
    write_text_file(output, page);
}

UnfinishedWebPage::UnfinishedWebPage(std::string option, std::filesystem::path folder, WebPlayer player,
                                     const std::vector<std::string>& own)
    : option_(std::move(option)), folder_(std::move(folder)), player_(std::move(player)), names_(player_.files) {
    expect_folder_name(option_, folder_);
    names_.emplace_back(kPageList);
    names_.insert(names_.end(), own.begin(), own.end());
    prepare_output_folder(option_, folder_);
    EarlierPage earlier = earlier_page(option_, folder_);
    replaced_ = std::move(earlier.files);
    earlier_html_ = std::move(earlier.html);
    std::error_code error;
    for (const std::string& name : names_)
        if (!contains(replaced_, name) && std::filesystem::exists(folder_ / name, error))
            throw InputError(option_, (folder_ / name).string(), "is not of the page that was published there",
                             "move it elsewhere");
    prepare_results(option_, folder_, replaced_);
    prepare_results(option_, folder_, names_);
    files_.emplace(folder_);
}

bool UnfinishedWebPage::is_edited() const {
    if (!std::filesystem::exists(folder_ / kPage)) return false;
    try {
        return text_of(folder_ / kPage) != earlier_html_;
    } catch (const InputError&) {
        return true;  // it cannot be read
    }
}

std::string UnfinishedWebPage::finish(const std::string& title) const {
    const bool has_sound = contains(names_, voctree::sound_file(kPageStream).string());
    const std::string html = page_of(player_, title, has_sound);
    bool stays = false;
    try {
        for (const std::string& name : player_.files) {
            std::filesystem::create_directories((path() / name).parent_path());
            if (name != kPage) std::filesystem::copy_file(player_.folder / name, path() / name);
        }
        write_text_file(path() / kPageList,
                        json_text({{"written_by", kPageWrittenBy}, {"files", names_}, {kPageHtml, html}}));
        // While there is no page, nothing looks finished, but for one that somebody has edited; while there is a list,
        // --overwrite may replace what is there.
        stays = is_edited();
        if (!stays) std::filesystem::remove(folder_ / kPage);
        for (const std::string& name : replaced_) {
            std::error_code others;  // lie in its folder, which then stays
            if (name != kPageList && name != kPage) std::filesystem::remove(folder_ / name);
            std::filesystem::remove((folder_ / name).parent_path(), others);
        }
        std::filesystem::rename(path() / kPageList, folder_ / kPageList);
        for (const std::string& name : names_) {
            if (name == kPage || name == kPageList) continue;
            std::filesystem::create_directories((folder_ / name).parent_path());
            std::filesystem::rename(path() / name, folder_ / name);
        }
    } catch (const std::filesystem::filesystem_error& error) {
        throw RuntimeFailure(fmt::format("{}: cannot be written: {}", folder_.string(), error.code().message()));
    }
    if (stays)
        return fmt::format("{}: is not as it was written, and stays; for the page of {}, move it elsewhere and repeat",
                           (folder_ / kPage).string(), title);
    write_text_file(folder_ / kPage, html);
    return "";
}

}  // namespace neuvv::tools
