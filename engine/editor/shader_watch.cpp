#include "editor/shader_watch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>
#include <utility>

namespace neuvv::editor {

namespace {

constexpr double kCheckInterval_s = 0.5;

}  // namespace

std::filesystem::path shaders_of_debug_build() {
#ifdef NEUVV_SHADER_FOLDER
    try {
        const ShaderSources sources(NEUVV_SHADER_FOLDER);
        return NEUVV_SHADER_FOLDER;
    } catch (const std::runtime_error&) {  // the sources have changed since the build
    }
#endif
    return {};
}

ShaderWatch::ShaderWatch(Parts parts, const std::filesystem::path& folder) : parts_(parts) {
    if (!folder.empty()) sources_ = std::make_shared<ShaderSources>(folder);
}

void ShaderWatch::tick(double now_s, bool may_replace) {
    if (!sources_ || checking_) return;
    if (compiled_ && may_replace) send_to_render_thread();
    if (now_s - checked_s_ < kCheckInterval_s) return;
    checked_s_ = now_s;
    checking_ = true;
    parts_.jobs.start("", [this, sources = sources_]() -> JobQueue::Then {
        const ShaderSources::Change change = sources->compile_changes();
        return [this, change, replacements = sources->replacements()] {
            checking_ = false;
            if (!change.problem.empty()) parts_.editor.notify(change.problem, true);
            if (change.compiled.empty()) return;
            compiled_ = replacements;
            names_ += fmt::format("{}{}", names_.empty() ? "" : ", ", fmt::join(change.compiled, ", "));
        };
    });
}

void ShaderWatch::send_to_render_thread() {
    parts_.render_thread.replace_shaders(
        *std::exchange(compiled_, std::nullopt),
        [parts = parts_, names = std::exchange(names_, {})](const std::string& problem) {
            parts.jobs.post([parts, names, problem] {
                const bool failed = !problem.empty();
                parts.editor.notify(failed ? problem : fmt::format("shaders made anew: {}", names), failed);
            });
        });
}

}  // namespace neuvv::editor
