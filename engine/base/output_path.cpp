#include "base/output_path.h"

#include <fmt/format.h>

#include <mutex>
#include <vector>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

namespace {

std::mutex g_mutex;                                 // of the next
std::vector<std::filesystem::path> g_folders_made;  // outer ones before inner ones

void make_folders(const std::filesystem::path& folder, std::error_code& error) {
    if (folder.empty() || std::filesystem::is_directory(folder, error)) return;
    make_folders(folder.parent_path(), error);
    if (!std::filesystem::create_directory(folder, error)) return;
    const std::lock_guard lock(g_mutex);
    g_folders_made.push_back(std::filesystem::absolute(folder));
}

}  // namespace

void prepare_output_folder(const Subject& output, const std::filesystem::path& folder) {
    std::error_code error;
    make_folders(folder, error);
    if (error)
        throw InputError(output, folder.string(), fmt::format("this folder cannot be made: {}", error.message()),
                         "choose another");
    if (!folder_is_writable(folder.empty() ? "." : folder))
        throw InputError(output, folder.string(), "this folder cannot be written into", "choose another");
}

void prepare_output_file(const Subject& output, const std::filesystem::path& file) {
    std::error_code ignored;
    if (!file.has_filename() || std::filesystem::is_directory(file, ignored))
        throw InputError(output, file.string(), "is a folder, not a file", "add a file name");
    if (const std::string why = why_not_replaced(file); !why.empty()) throw InputError(output, file.string(), why);
    prepare_output_folder(output, link_target(file).parent_path());
}

void remove_empty_output_folders() {
    const std::lock_guard lock(g_mutex);
    std::error_code ignored;  // of folders that are not empty
    while (!g_folders_made.empty()) {
        std::filesystem::remove(g_folders_made.back(), ignored);
        g_folders_made.pop_back();
    }
}

void write_text_file(const std::filesystem::path& file, const std::string& text) {
    write_file_atomically(file, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

}  // namespace neuvv
