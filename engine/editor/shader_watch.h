// Shaders that are changed while the program runs show in the image: the job queue compiles them, then the render
// thread makes its passes again. Where they do not compile, the user is told why and the image stays.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "editor/parts.h"
#include "editor/shader_sources.h"

namespace neuvv::editor {

// The folder of a debug build's sources where it is there, else empty.
std::filesystem::path shaders_of_debug_build();

class ShaderWatch {
  public:
    // With an empty folder nothing is watched. Throws InputError like ShaderSources.
    ShaderWatch(Parts parts, const std::filesystem::path& folder);
    // Each frame. Passes are made again only while `may_replace`: the images of an export all come from the same
    // shaders.
    void tick(double now_s, bool may_replace);

  private:
    Parts parts_;
    std::shared_ptr<ShaderSources> sources_;  // used by jobs alone, one after the other
    double checked_s_ = 0;
    bool checking_ = false;
    std::optional<gpu::ShaderReplacements> compiled_;  // that the render thread does not have yet
    std::string names_;                                // of their sources
    void send_to_render_thread();
};

}  // namespace neuvv::editor
