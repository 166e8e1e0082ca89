// The sources of the renderer's shaders in a folder, and what has changed of them since the program began to look: for
// those who write shaders and look at what they do.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "gpu/shader_table.h"

namespace neuvv::editor {

class ShaderSources {
  public:
    // A folder like this project's shaders/, as it is now. Throws InputError where one of the shaders is not there.
    explicit ShaderSources(std::filesystem::path folder);

    // What came of the files that are others than at the last call: glslangValidator of PATH, as the build runs it.
    struct Change {
        std::vector<std::string> compiled;  // files of shaders, of themselves or of what they include
        std::string problem;                // a line; empty: none
    };
    // Some of a second for each shader. Where one does not compile, none of the change counts until it does.
    Change compile_changes();
    // All that were compiled, as of the last call of look() without a problem.
    const gpu::ShaderReplacements& replacements() const { return replacements_; }

  private:
    using Times = std::map<std::filesystem::path, std::filesystem::file_time_type>;
    Times times() const;
    std::set<std::filesystem::path> included(const std::filesystem::path& file) const;
    void find_stale(const std::set<std::filesystem::path>& changed);
    std::vector<uint32_t> compiled(const std::string& file) const;

    std::filesystem::path folder_;
    Times last_times_;
    std::set<std::string> stale_;   // changed, and not compiled since
    std::filesystem::path shared_;  // of shared/, changed: the program has another one until it is built anew
    gpu::ShaderReplacements replacements_;
};

}  // namespace neuvv::editor
