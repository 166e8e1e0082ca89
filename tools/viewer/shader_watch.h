// Shaders that are changed while the window is open are seen in the picture: compiled by Work, then the drawer makes
// its passes again. Where they do not compile, the notice says why and the picture stays.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "tools/viewer/shader_sources.h"

namespace neuvv::viewer {

class Viewer;

// The folder of a debug build's sources where it is there, else empty.
std::filesystem::path shaders_of_debug_build();

class ShaderWatch {
  public:
    // Empty: nothing is watched. Throws InputError like ShaderSources.
    explicit ShaderWatch(const std::filesystem::path& folder);
    // Each frame.
    void tick(Viewer& viewer);

  private:
    std::shared_ptr<ShaderSources> sources_;  // used by jobs alone, one after the other
    double looked_s_ = 0;
    bool looking_ = false;
    std::optional<gpu::ShaderReplacements> compiled_;  // that the drawer does not have yet
    std::string names_;                                // of their sources
    void give(Viewer& viewer);
};

}  // namespace neuvv::viewer
