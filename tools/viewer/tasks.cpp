#include "tools/viewer/tasks.h"

#include "base/platform.h"

namespace neuvv::viewer {

Tasks::Tasks(Context& context, Preferences& preferences, Panels& panels, const std::string& device,
             const std::filesystem::path& shaders)
    : verb(device, program_file()),
      files(context, preferences, exporter,
            {[&panels] { panels.document_opened(); },
             [&panels](std::set<std::filesystem::path> layers) { panels.paint.protect_layers(std::move(layers)); },
             [this](const std::string& name, const std::filesystem::path& input) { verb.ask(name, input); },
             [this, &context](const std::filesystem::path& motion) {
                 coaching.address = motion.string();
                 coaching.begin(context);
             }}),
      shader_watch(context.parts(), shaders) {}

void Tasks::tick(Context& context, std::span<const std::filesystem::path> dropped) {
    files.tick();
    shader_watch.tick(context.frame.now_s, !exporter.job());
    exporter.tick(context);
    for (const std::filesystem::path& path : dropped) files.open_or_add(path);
}

}  // namespace neuvv::viewer
