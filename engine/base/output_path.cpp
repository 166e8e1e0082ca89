#include "base/output_path.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

void prepare_output_folder(const std::string& option, const std::filesystem::path& folder) {
    std::error_code error;
    if (!folder.empty()) std::filesystem::create_directories(folder, error);
    if (error)
        throw InputError(option, folder.string(), fmt::format("this folder cannot be made: {}", error.message()),
                         "choose another");
    if (!folder_is_writable(folder.empty() ? "." : folder))
        throw InputError(option, folder.string(), "this folder cannot be written into", "choose another");
}

void prepare_output_file(const std::string& option, const std::filesystem::path& file) {
    std::error_code ignored;
    if (!file.has_filename() || std::filesystem::is_directory(file, ignored))
        throw InputError(option, file.string(), "is a folder, not a file", "add a file name");
    if (!is_replaceable(file))
        throw InputError(option, file.string(), "is no regular file, and would be replaced", "choose another");
    prepare_output_folder(option, link_target(file).parent_path());
}

void write_text_file(const std::filesystem::path& file, const std::string& text) {
    write_file_atomically(file, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

}  // namespace neuvv
