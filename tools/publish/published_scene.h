// What `neuvv publish` and `neuvv export` take: a clip, or a performer of a stage: its clip with its paint.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "render/clips/segment_paint.h"
#include "stage/stage.h"
#include "voctree/files/clip_index.h"
#include "voctree/slice_paint.h"

namespace neuvv::tools {

struct PublishedScene {
    std::filesystem::path clip;
    voctree::ClipIndex index;     // of the clip
    render::LayerFolders layers;  // the performer's visible ones, the lowest first; folders where the clip has segments
    std::shared_ptr<const stage::Stage> stage{};  // none where the scene is a clip
    uint32_t performer = 0;                       // index into the stage's performers
};

// `performer`: the node of a stage, by its name or index; empty for the only performer of a stage, and for a clip.
// Throws InputError where there is no such performer, for a stream that is painted, and where a layer's folder is
// missing.
PublishedScene read_published_scene(const std::string& scene, const std::string& performer,
                                    std::optional<voctree::UpAxis> up);

// The same of a performer of a stage that was read, by its index in the stage.
PublishedScene published_performer(std::shared_ptr<const stage::Stage> stage, uint32_t performer);

// The layers of a performer's paint that are seen, the lowest first.
render::LayerFolders visible_layers(const stage::Stage& stage, const stage::StagePerformer& performer);

// The paint of one segment.
struct SegmentLayers {
    std::vector<std::unique_ptr<const voctree::EditLayer>> edits;  // `steps` points to them
    std::vector<voctree::PaintStep> steps;                         // those that have edits, the lowest first
};
// Throws InputError where a layer cannot be read, or is paint on another tree than the segment's.
SegmentLayers read_segment_layers(const PublishedScene& scene, const voctree::ClipSegment& segment,
                                  const voctree::VOctree& tree);

}  // namespace neuvv::tools
