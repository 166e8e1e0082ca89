#include "tools/viewer/shader_watch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>
#include <utility>

#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

namespace {

constexpr double kLookEvery_s = 0.5;

}  // namespace

std::filesystem::path shaders_of_debug_build() {
#ifdef NEUVV_SHADER_FOLDER
    try {
        const ShaderSources sources(NEUVV_SHADER_FOLDER);
        return NEUVV_SHADER_FOLDER;
    } catch (const std::runtime_error&) {  // they have gone on since
    }
#endif
    return {};
}

ShaderWatch::ShaderWatch(const std::filesystem::path& folder) {
    if (!folder.empty()) sources_ = std::make_shared<ShaderSources>(folder);
}

void ShaderWatch::tick(Viewer& viewer) {
    if (!sources_ || looking_) return;
    if (compiled_ && !viewer.exporting) give(viewer);  // an export's pictures are all of the same shaders
    if (viewer.now_s - looked_s_ < kLookEvery_s) return;
    looked_s_ = viewer.now_s;
    looking_ = true;
    viewer.work.start("", [this, &viewer, sources = sources_]() -> Work::Then {
        const ShaderSources::Change change = sources->look();
        return [this, &viewer, change, replacements = sources->replacements()] {
            looking_ = false;
            if (!change.problem.empty()) viewer.editor.tell(change.problem, true);
            if (change.compiled.empty()) return;
            compiled_ = replacements;
            names_ += fmt::format("{}{}", names_.empty() ? "" : ", ", fmt::join(change.compiled, ", "));
        };
    });
}

void ShaderWatch::give(Viewer& viewer) {
    viewer.drawer.remake(*std::exchange(compiled_, std::nullopt), [&viewer, names = std::exchange(names_, {})](
                                                                      const std::string& problem) {
        viewer.work.tell([&viewer, names, problem] {
            const bool failed = !problem.empty();
            viewer.editor.tell(failed ? problem : fmt::format("shaders made anew: {}", names), failed);
        });
    });
}

}  // namespace neuvv::viewer
