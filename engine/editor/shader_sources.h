// The sources of the renderer's shaders in a folder. Those that change while the program runs are compiled, so that a
// shader's author sees the effect at once.
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
    // `folder` is laid out like this project's shaders/. Its state now is what changes are compared with. Throws
    // InputError where one of the renderer's shaders is missing.
    explicit ShaderSources(std::filesystem::path folder);

    // The result of compiling what changed since the last call.
    struct Change {
        std::vector<std::string> compiled;  // the files of the shaders, relative to the folder
        std::string problem;                // one line; empty: none
    };
    // Compiles the shaders whose files, or files that they include, changed since the last call, with the
    // glslangValidator of PATH and the options of the build, those for both kinds of buffers where the build has both.
    // Takes part of a second per shader. Where one does not compile, none of them is replaced until it does.
    Change compile_changes();
    // The SPIR-V of all shaders that were compiled, as of the last call of compile_changes() without a problem.
    const gpu::ShaderReplacements& replacements() const { return replacements_; }

  private:
    using Times = std::map<std::filesystem::path, std::filesystem::file_time_type>;
    Times times() const;
    std::set<std::filesystem::path> included(const std::filesystem::path& file) const;
    void find_stale(const std::set<std::filesystem::path>& changed);
    std::vector<uint32_t> compiled(const std::string& file, bool storage) const;

    std::filesystem::path folder_;
    Times last_times_;
    std::set<std::string> stale_;  // the shaders that must be compiled
    std::filesystem::path
        shared_;  // a header of shared/ that changed: C++ has the old one until the program is built again
    gpu::ShaderReplacements replacements_;
};

}  // namespace neuvv::editor
