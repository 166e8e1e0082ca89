// Watches the sources of the shaders and shows changes in the image: the job queue compiles what changed, then the
// render thread makes its passes again. Where a shader does not compile, a notice says why and the image stays.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "editor/parts.h"
#include "editor/shader_sources.h"

namespace neuvv::editor {

// In a debug build, the folder of the shaders that it was built from, where that is still complete; else empty.
std::filesystem::path shaders_of_debug_build();

class ShaderWatch {
  public:
    // With an empty folder nothing is watched. Throws InputError like ShaderSources.
    ShaderWatch(Parts parts, const std::filesystem::path& folder);
    // To be called once a frame. Passes are made again only while `may_replace`, so that all images of an export come
    // from the same shaders.
    void tick(double now_s, bool may_replace);

  private:
    Parts parts_;
    std::shared_ptr<ShaderSources> sources_;  // only jobs use it, one at a time
    double checked_s_ = 0;
    bool checking_ = false;
    std::optional<gpu::ShaderReplacements> compiled_;  // not yet given to the render thread
    std::string names_;                                // the files of these shaders, for the notice
    void send_to_render_thread();
};

}  // namespace neuvv::editor
