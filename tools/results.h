// Results: the files that a verb makes, checked before it does any work. One rule holds for all verbs: a result that is
// there is kept unless the user gives --overwrite, and what else the command line names is never written to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "media/image_sink.h"

namespace neuvv::tools {

// What the command line of this process says of files. Until it is set, nothing is named and nothing is kept.
struct GivenPath {
    std::string option;  // "--json", or "scene" of a positional argument
    std::filesystem::path path;
};
struct GivenPaths {
    std::vector<GivenPath> paths;  // all values of all options, whether they are paths or not
    bool overwrite = false;
};
void set_given_paths(GivenPaths given);
bool may_overwrite();

// Endings of results that several verbs have.
inline const std::vector<std::string_view> kJsonEnding{".json"}, kHtmlEndings{".html", ".htm"}, kCsvEnding{".csv"};

// Throws InputError where the file does not end with one of `endings` (none: any), where it is what another option
// names or the verb reads, where it is there and may not be replaced, and where it could not be written. Makes its
// folder.
void prepare_result(const std::string& option, const std::filesystem::path& file,
                    const std::vector<std::string_view>& endings = {});
// The same without looking whether it is there: of a file that the program keeps up to date, or that it goes on with.
void prepare_live_file(const std::string& option, const std::filesystem::path& file,
                       const std::vector<std::string_view>& endings);
// Throws InputError where the file is one of those that the verb reads, or would be once it is there: of a file that is
// gone on with later, when nobody can tell whose it is.
void expect_no_input(const std::string& option, const std::filesystem::path& file);
// As prepare_result, of files that are written into a folder. Makes it.
void prepare_results(const std::string& option, const std::filesystem::path& folder,
                     const std::vector<std::string>& names);

// The same of the images from number `first` to before `end`, or of the video that they become.
void prepare_images(const std::string& option, const media::ImageOutput& output, uint32_t first, uint32_t end);

// The same of a file or a folder that the caller has found there. Throws InputError unless it may be replaced.
void expect_replaceable(const std::string& option, const std::filesystem::path& result);

// Throws InputError where there is neither such a file nor such a folder. Addresses are not looked at, nor is an empty
// name.
void expect_there(const std::filesystem::path& file);

}  // namespace neuvv::tools
