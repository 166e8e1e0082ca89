#include "tools/unfinished_folder.h"

#include <fmt/format.h>

#include <regex>
#include <vector>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "tools/results.h"
#include "training/data/write_dataset.h"

namespace neuvv::tools {

namespace {

// Key points are what a detector found in the images, mattes what was made of them.
constexpr const char* kFolders[] = {"images", "videos", "plates", "key_points", "mattes"};
constexpr const char* kFiles[] = {"skeleton.glb", "studio.json", "transforms_test.json",
                                  "transforms_train.json"};  // the last are last

// Files of a folder that have the names of a capture's.
std::vector<std::filesystem::path> captured_files(const std::filesystem::path& folder) {
    static const std::regex kName("(videos_)?c[0-9]{2,}(_f?[0-9]{3,})?(\\.png|\\.jpg|\\.mp4|_keypoints\\.json)");
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
        if (std::regex_match(entry.path().filename().string(), kName)) files.push_back(entry.path());
    return files;
}

// Whether this program wrote the data set in the folder, as one of its files says.
bool is_written_dataset(const std::filesystem::path& folder) {
    for (const char* name : training::kWrittenFiles) try {
            const JsonFile file = read_json(folder / name, "a data set");
            if (file.document.contains("written_by") && file.document["written_by"] == training::kWrittenBy)
                return true;
        } catch (const InputError&) {  // it is not there, or of another program
        }
    return false;
}

bool lies_within(const std::filesystem::path& inner, const std::filesystem::path& outer) {
    std::error_code error;
    const std::filesystem::path a = std::filesystem::weakly_canonical(inner, error),
                                b = std::filesystem::weakly_canonical(outer, error), relative = a.lexically_relative(b);
    return a == b || (!relative.empty() && *relative.begin() != "..");
}

}  // namespace

UnfinishedFiles::UnfinishedFiles(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::error_code ignored;
    std::filesystem::remove_all(path(), ignored);
    prepare_output_folder("--output", path());
}

UnfinishedFiles::~UnfinishedFiles() {
    std::error_code ignored;
    std::filesystem::remove_all(path(), ignored);
}

void UnfinishedFiles::finish() const {
    try {
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::directory_iterator(path())) files.push_back(entry.path());
        for (const std::filesystem::path& file : files) std::filesystem::rename(file, folder_ / file.filename());
    } catch (const std::filesystem::filesystem_error& error) {
        throw RuntimeFailure(fmt::format("{}: cannot be written: {}", folder_.string(), error.code().message()));
    }
}

UnfinishedFolder::UnfinishedFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
    prepare_results("--output", folder_, {std::begin(kFiles), std::end(kFiles)});
    std::error_code error;
    for (const char* name : kFolders)
        if (std::filesystem::exists(folder_ / name, error) && !std::filesystem::is_empty(folder_ / name, error))
            expect_replaceable("--output", folder_ / name);
    files_.emplace(folder_);
}

void UnfinishedFolder::finish() const {
    try {
        for (auto name = std::rbegin(kFiles); name != std::rend(kFiles); ++name)
            std::filesystem::remove(folder_ / *name);
        for (const char* name : kFolders) {
            for (const std::filesystem::path& old : captured_files(folder_ / name)) std::filesystem::remove(old);
            if (std::filesystem::exists(path() / name)) std::filesystem::create_directories(folder_ / name);
            for (const std::filesystem::path& file : captured_files(path() / name))
                std::filesystem::rename(file, folder_ / name / file.filename());
        }
        for (const char* name : kFiles)
            if (std::filesystem::exists(path() / name)) std::filesystem::rename(path() / name, folder_ / name);
    } catch (const std::filesystem::filesystem_error& error) {
        throw RuntimeFailure(fmt::format("{}: cannot be written: {}", folder_.string(), error.code().message()));
    }
}

UnfinishedDataset::UnfinishedDataset(std::filesystem::path folder, const std::filesystem::path& from)
    : folder_(std::move(folder)) {
    if (lies_within(from, folder_))
        throw InputError("--output", folder_.string(), "holds the data set that is read", "choose another folder");
    prepare_output_folder("--output", folder_);
    std::error_code ignored;
    bool empty = true;
    for (const auto& entry : std::filesystem::directory_iterator(folder_, ignored))
        empty = empty && entry.path().filename() == "unfinished";
    if (!empty && !is_written_dataset(folder_))
        throw InputError("--output", folder_.string(), "holds other files than such a data set",
                         "choose an empty folder or a new one");
    if (!empty) expect_replaceable("--output", folder_);
    files_.emplace(folder_);
}

void UnfinishedDataset::finish() const {
    try {
        for (const char* name : training::kWrittenFiles) std::filesystem::remove(folder_ / name);
        for (const char* name : training::kWrittenFolders) {
            std::filesystem::remove_all(folder_ / name);
            if (std::filesystem::exists(path() / name)) std::filesystem::rename(path() / name, folder_ / name);
        }
        for (const char* name : training::kWrittenFiles)
            if (std::filesystem::exists(path() / name)) std::filesystem::rename(path() / name, folder_ / name);
    } catch (const std::filesystem::filesystem_error& error) {
        throw RuntimeFailure(fmt::format("{}: cannot be written: {}", folder_.string(), error.code().message()));
    }
}

}  // namespace neuvv::tools
