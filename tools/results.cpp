#include "tools/results.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/output_path.h"
#include "base/text.h"
#include "editor/open_file.h"
#include "stage/file/stage_file.h"
#include "stream/transport/byte_source.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

namespace {

// What data sets and captures consist of. Other files that lie in such a folder are results.
const std::set<std::string> kDataEndings = {".json", ".csv", ".xml", ".txt", ".bin",  ".yml", ".yaml",
                                            ".toml", ".npy", ".png", ".jpg", ".jpeg", ".exr", ".tif",
                                            ".mp4",  ".mov", ".mkv", ".avi", ".webm", ".m4v", ".mts"};

GivenPaths& given() {
    static GivenPaths paths;
    return paths;
}

// Whether both name one file or folder, by whatever links, or would once it is there.
bool is_same(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code error;
    if (std::filesystem::equivalent(a, b, error) && !error) return true;
    const std::filesystem::path whole_a = std::filesystem::weakly_canonical(a, error);
    if (error) return false;
    const std::filesystem::path whole_b = std::filesystem::weakly_canonical(b, error);
    return !error && !a.empty() && whole_a == whole_b;
}

bool lies_in(const std::filesystem::path& file, const std::filesystem::path& folder) {
    std::error_code error;
    const std::filesystem::path inner = std::filesystem::weakly_canonical(file, error);
    const std::filesystem::path relative = inner.lexically_relative(std::filesystem::weakly_canonical(folder, error));
    return !error && !relative.empty() && *relative.begin() != "..";
}

// The files that a stage names anywhere: clips, paint, sounds, buffers, images.
void add_uris(const nlohmann::json& value, std::vector<std::string>& uris) {
    if (value.is_object())
        for (const auto& [name, member] : value.items())
            if (name == "uri" && member.is_string()) uris.push_back(member.get<std::string>());
    if (value.is_structured())
        for (const nlohmann::json& member : value) add_uris(member, uris);
}

bool is_named_by_stage(const std::filesystem::path& file, const std::filesystem::path& stage) {
    try {
        const stage::StageFile read = stage::read_stage_file(stage);
        std::vector<std::string> uris;
        add_uris(nlohmann::json::parse(std::string(read.json.text())), uris);
        return std::ranges::any_of(
            uris, [&](const std::string& uri) { return is_same(file, stage.parent_path() / stage::decoded_uri(uri)); });
    } catch (const std::exception&) {  // the verb itself says what is wrong with the stage
        return false;
    }
}

// What a value of an option names: itself, or where it is a list, its parts without what follows a colon.
std::vector<std::filesystem::path> paths_of(const std::filesystem::path& value) {
    std::vector<std::filesystem::path> paths{value};
    for (const std::string& part : split(value.string(), ',')) paths.emplace_back(part.substr(0, part.find(':')));
    return paths;
}

// Whether the verb reads this file because an option names this path, or would once it is there: as one of a folder or
// as one of a stage.
bool belongs_to(const std::filesystem::path& file, const std::filesystem::path& path) {
    std::error_code error;
    if (path.empty()) return false;
    if (std::filesystem::is_directory(path, error))
        return lies_in(file, path) &&
               (voctree::is_segmented(path) || kDataEndings.contains(lower_case(file.extension().string())));
    return editor::has_stage_ending(path) && is_named_by_stage(file, path);
}

// Calls `check` with all that options name but this one.
void for_each_other(const std::string& option,
                    const std::function<void(const std::string& option, const std::filesystem::path& path)>& check) {
    for (const GivenPath& other : given().paths)
        if (other.option != option)
            for (const std::filesystem::path& path : paths_of(other.path)) check(other.option, path);
}

}  // namespace

void set_given_paths(GivenPaths paths) {
    given() = std::move(paths);
}

bool may_overwrite() {
    return given().overwrite || given().paths.empty();
}

void expect_replaceable(const std::string& option, const std::filesystem::path& result) {
    if (!may_overwrite())
        throw InputError(option, result.string(), "is there already",
                         "choose another name; --overwrite replaces it once the new one is whole");
}

void expect_no_input(const std::string& option, const std::filesystem::path& file) {
    for_each_other(option, [&](const std::string&, const std::filesystem::path& path) {
        if (belongs_to(file, path))
            throw InputError(option, file.string(),
                             fmt::format("belongs to {}, which this command reads", path.string()),
                             "choose another name");
    });
}

void prepare_live_file(const std::string& option, const std::filesystem::path& file,
                       const std::vector<std::string_view>& endings) {
    if (!endings.empty() && std::ranges::find(endings, lower_case(file.extension().string())) == endings.end())
        throw InputError(option, file.string(), fmt::format("does not end with {}", fmt::join(endings, " or ")),
                         "name it so");
    for_each_other(option, [&](const std::string& other, const std::filesystem::path& path) {
        if (is_same(file, path))
            throw InputError(option, file.string(), fmt::format("is what {} names, too", other), "choose another name");
    });
    prepare_output_file(option, file);
}

void prepare_result(const std::string& option, const std::filesystem::path& file,
                    const std::vector<std::string_view>& endings) {
    std::error_code error;
    const bool is_there = std::filesystem::is_regular_file(file, error);
    prepare_live_file(option, file, endings);
    if (std::filesystem::exists(file, error)) expect_no_input(option, file);
    if (is_there) expect_replaceable(option, file);
}

void prepare_results(const std::string& option, const std::filesystem::path& folder,
                     const std::vector<std::string>& names) {
    prepare_output_folder(option, folder);
    for (const std::string& name : names) prepare_result(option, folder / name);
}

void expect_there(const std::filesystem::path& file) {
    std::error_code error;
    if (file.empty() || stream::is_address(file) || std::filesystem::exists(file, error)) return;
    throw InputError(file.string(), "", error ? error.message() : "there is no such file or folder", "check the path");
}

void prepare_images(const std::string& option, const media::ImageOutput& output, uint32_t first, uint32_t end) {
    if (output.kind != media::ImageOutput::Kind::kNumberedImages) return prepare_result(option, output.path);
    prepare_output_file(option, output.path);
    std::error_code error;
    for (uint32_t i = first; i < end; ++i)
        if (std::filesystem::exists(output.file(i), error)) prepare_result(option, output.file(i));
}

}  // namespace neuvv::tools
