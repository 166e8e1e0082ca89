#include "training/data/layouts/rig/candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "base/text.h"
#include "training/data/layouts/rig/camera_folders.h"

namespace neuvv::training {

namespace {

// A path in a remark: the file's name, with its folder where that is no data set's own.
std::string short_name(const std::filesystem::path& path) {
    const std::string folder = path.parent_path().filename().string();
    return lower_case(folder).find("calib") == std::string::npos ? path.filename().string()
                                                                 : folder + "/" + path.filename().string();
}

bool is_drive(const std::string& name) {
    return name.size() >= 2 && std::isalpha(static_cast<unsigned char>(name[0])) != 0 && name[1] == ':';
}

}  // namespace

bool is_hidden(const std::filesystem::path& path) {
    return path.filename().string().starts_with('.');
}

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> entries;
    std::error_code failed;
    for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed))
        if (!is_hidden(entry->path())) entries.push_back(entry->path());
    std::ranges::sort(entries);
    return entries;
}

std::string portable_name(std::string name) {
    std::ranges::replace(name, '\\', '/');
    if (is_drive(name)) name = std::filesystem::path(name).filename().string();
    return name;
}

std::string first_names(const std::vector<std::string>& names) {
    constexpr size_t kMostNames = 4;
    std::string text;
    for (size_t i = 0; i < std::min(names.size(), kMostNames); ++i) text += (i == 0 ? "" : ", ") + names[i];
    if (names.size() > kMostNames) text += fmt::format(" and {} more", names.size() - kMostNames);
    return text;
}

std::string choice_remark(const std::string& chosen, const std::vector<std::string>& others) {
    return fmt::format("{} was read, not {}", chosen, first_names(others));
}

std::string entries_text(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : entries_of(folder))
        names.push_back(entry.filename().string() + (std::filesystem::is_directory(entry, ignored) ? "/" : ""));
    return names.empty() ? "nothing" : first_names(names);
}

Choice newest_of(std::vector<std::filesystem::path> files) {
    if (files.empty()) return {};
    std::ranges::sort(files);
    std::map<std::filesystem::path, std::filesystem::file_time_type> dates;
    std::error_code ignored;
    for (const auto& file : files) dates[file] = std::filesystem::last_write_time(file, ignored);
    std::ranges::stable_sort(files, [&](const auto& a, const auto& b) { return dates.at(a) < dates.at(b); });
    const std::filesystem::path chosen = files.back();
    files.pop_back();
    if (files.empty()) return {chosen, ""};
    const bool alone = dates.at(files.back()) < dates.at(chosen);
    std::vector<std::string> others;
    for (const auto& file : files) others.push_back(short_name(file));
    return {chosen,
            choice_remark(fmt::format("{}, {}", short_name(chosen),
                                      alone ? "the newest such file," : "the last by name of files of one date,"),
                          others)};
}

std::vector<std::filesystem::path> calibration_folders(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> folders = {folder};
    std::error_code ignored;
    for (const auto& entry : entries_of(folder))
        if (lower_case(entry.filename().string()).find("calib") != std::string::npos &&
            std::filesystem::is_directory(entry, ignored))
            folders.push_back(entry);
    return folders;
}

std::vector<std::vector<std::filesystem::path>> session_folders(const std::filesystem::path& folder) {
    constexpr int kLevels = 2;  // a session may have a folder for each participant, which has one for each trial
    std::vector<std::vector<std::filesystem::path>> sessions;
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder / "videos", ignored) &&
        !std::filesystem::is_directory(folder / "pose", ignored))
        return sessions;
    std::filesystem::path above = std::filesystem::absolute(folder, ignored).lexically_normal();
    if (!above.has_filename()) above = above.parent_path();  // a name that ends with a slash
    for (int level = 0; level < kLevels && above.has_relative_path(); ++level) {
        above = above.parent_path();
        sessions.push_back(calibration_folders(above));
    }
    return sessions;
}

Choice images_folder(const std::filesystem::path& folder) {
    std::map<std::string, std::filesystem::path, NaturalOrder> found;
    std::error_code ignored;
    for (const auto& entry : entries_of(folder)) {
        const std::string name = entry.filename().string();
        const bool copies = name.starts_with("images_") && name.size() > 7 &&
                            std::ranges::all_of(name.substr(7), [](unsigned char c) { return std::isdigit(c) != 0; });
        if ((name == "images" || copies) && std::filesystem::is_directory(entry, ignored)) found[name] = entry;
    }
    if (found.empty()) return {folder / "images", ""};
    std::vector<std::string> others;
    for (auto other = std::next(found.begin()); other != found.end(); ++other) others.push_back(other->first + "/");
    const auto& [name, path] = *found.begin();
    return {path, others.empty() ? "" : choice_remark(name + "/", others)};
}

}  // namespace neuvv::training
