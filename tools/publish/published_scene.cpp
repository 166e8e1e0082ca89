#include "tools/publish/published_scene.h"

#include <fmt/format.h>

#include "base/error.h"
#include "editor/open_file.h"
#include "stage/stage.h"
#include "tools/stage/stage_verbs.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::tools {

namespace {

bool has_folders(const PublishedScene& scene) {
    return scene.index.segments.size() > 1;
}

}  // namespace

render::LayerFolders visible_layers(const stage::Stage& stage, const stage::StagePerformer& performer) {
    render::LayerFolders layers;
    for (size_t i = 0; i < performer.settings.paint.size(); ++i) {
        const stage::PaintLayer& layer = performer.settings.paint[i];
        if (!layer.visible || layer.opacity <= 0) continue;
        const std::string place = fmt::format("\"{}\": paint layer {}", performer.name, i);
        layers.push_back({stage::absolute_path(stage::file_of_uri(stage.file, layer.uri, place)), layer.blend,
                          static_cast<float>(layer.opacity)});
    }
    return layers;
}

PublishedScene published_performer(std::shared_ptr<const stage::Stage> stage, uint32_t performer) {
    const stage::StagePerformer& found = stage->performers[performer];
    PublishedScene scene{stage->clips[found.clip].path, {}, visible_layers(*stage, found)};
    scene.stage = std::move(stage);
    scene.performer = performer;
    scene.index = voctree::read_clip_index(scene.clip, up_of(scene.clip, std::nullopt));
    if (!scene.layers.empty()) voctree::expect_no_stream(scene.clip);
    if (has_folders(scene))
        for (const render::LayerFolder& layer : scene.layers) voctree::expect_paint_folder(layer.folder);
    return scene;
}

PublishedScene read_published_scene(const std::string& path, const std::string& performer,
                                    std::optional<voctree::UpAxis> up) {
    if (editor::has_stage_ending(path)) {
        up_of(path, up);  // throws where it is given: clips of stages say themselves which way is up
        const auto stage = std::make_shared<const stage::Stage>(stage::load_stage(path));
        return published_performer(stage, find_performer(*stage, "--performer", performer));
    }
    if (!performer.empty())
        throw InputError("--performer", performer, "is for stages", "leave it out: a clip is one performer");
    PublishedScene scene{voctree::clip_path(path), {}, {}};
    scene.index = voctree::read_clip_index(scene.clip, up_of(path, up));
    return scene;
}

SegmentLayers read_segment_layers(const PublishedScene& scene, const voctree::ClipSegment& segment,
                                  const voctree::VOctree& tree) {
    SegmentLayers read;
    if (scene.layers.empty()) return read;
    const voctree::PaintedField field = voctree::painted_field(tree);
    for (const render::LayerFolder& layer : scene.layers) {
        auto edits = std::make_unique<const voctree::EditLayer>(
            has_folders(scene) ? voctree::read_segment_paint(layer.folder, segment, field)
                               : voctree::read_paint(layer.folder, field));
        if (edits->edits.empty()) continue;
        read.steps.push_back({edits.get(), static_cast<uint32_t>(layer.blend), layer.opacity});
        read.edits.push_back(std::move(edits));
    }
    return read;
}

}  // namespace neuvv::tools
