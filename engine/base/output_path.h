// Where results are written: checked before any work, so that no work is lost where they could not be.
#pragma once

#include <filesystem>
#include <string>

#include "base/error.h"

namespace neuvv {

// Both make the folder (or the file's folder) where it is missing, and throw InputError where it cannot be written
// into; an empty folder is the working directory. `output` is for the error.
void prepare_output_folder(const Subject& output, const std::filesystem::path& folder);
void prepare_output_file(const Subject& output, const std::filesystem::path& file);
// Removes those folders that the two have made and that nothing was written into: the program failed.
void remove_empty_output_folders();
// Writes a whole file, atomically. Throws RuntimeFailure.
void write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace neuvv
