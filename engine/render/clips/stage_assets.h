// Stage assets: the contents of a stage's files, read from the disk and uploaded to the device for a StageRenderer.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "render/clips/clip_files.h"
#include "render/clips/paint_files.h"
#include "render/set/set_raster.h"
#include "stage/stage.h"

namespace neuvv::render {

// A clip of a stage. Of a segmented one, only some segments are on the device (StageClips chooses them); a clip that is
// one file is a single segment.
struct ClipOnDevice {
    struct Segment {
        std::shared_ptr<const LoadedClip> loaded;  // null: not on the device
        std::shared_ptr<const LoadedClip>
            coarse;  // its coarse tree, or what came in time of a stream's frame, until the whole is there; mostly null
        bool readable = true;        // false: it is missing or damaged, and is not shown
        ClipFiles::Paints paints{};  // of a segmented clip: for each of `layers`, of what is loaded
    };
    voctree::ClipIndex index;
    std::vector<Segment> segments;  // in the order of the index
    // One that is there: of files, the first that could be read, which stays on the device; of a stream, any frame.
    std::shared_ptr<const LoadedClip> first;
    std::pair<glm::dvec3, glm::dvec3> leaf_box{};  // around the leaves of all (min, max), performer's space, metres
    std::vector<LayerFolders> layers{};            // of a segmented clip: what performers are painted with, each once
};

// A visible layer of a performer's paint.
struct LoadedLayer {
    std::shared_ptr<const voctree::EditLayer> edits;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
    auto operator<=>(const LoadedLayer&) const = default;
};

constexpr uint32_t kNoLayers = UINT32_MAX;

struct StageAssets {
    std::vector<ClipOnDevice> clips;                    // in the order of Stage::clips
    std::shared_ptr<const SetEnvironment> environment;  // black where the stage has none
    // By performer: the visible layers, the lowest first; and on a segmented clip, an index into ClipOnDevice::layers,
    // kNoLayers where there are none.
    std::vector<std::vector<LoadedLayer>> paint;
    std::vector<uint32_t> layers;
    std::vector<Note> problems;        // one for each segment that cannot be read
    std::shared_ptr<ClipFiles> files;  // reads the segments that are not on the device
};

// Reads the files of a stage, and of its later versions only what has changed: an asset of an earlier load that is
// still in use, and whose file has not changed, is not read again.
class StageLoader {
  public:
    // Called after each clip, with the number of clips so far and in all.
    using Loaded = std::function<void(size_t, size_t)>;

    // The device must outlive the loader and all that it loads. Layers that `paint` returns are not read from the disk.
    explicit StageLoader(const gpu::Device& device, PaintSource paint = {}, SolidParts solid = SolidParts::kNo);

    // Of a segmented clip of which nothing is on the device, the first segment is read, and of the others their headers
    // alone. Throws InputError for a file that cannot be read, for a segmented clip of which no segment can be, and for
    // paint of another clip; RuntimeFailure where the device has no memory.
    StageAssets load(const stage::Stage& stage, const Loaded& loaded = {});
    // What it reads clips with: what is read by others beforehand and still in use is not read again.
    const std::shared_ptr<ClipFiles>& files() const { return files_; }

  private:
    struct KnownEnvironment {
        std::filesystem::path path;  // empty: none
        FileStamp stamp;
        std::weak_ptr<const SetEnvironment> map;
    };
    // What the header of a segment's file says, so that it is read again only where the file has changed.
    struct KnownHeader {
        FileStamp stamp;
        std::optional<std::pair<glm::dvec3, glm::dvec3>> box;  // of its tree, metres; nothing: no leaves
        Note problem;                                          // empty: it is sound
    };
    const KnownHeader& header_of(const voctree::ClipSegment& segment);
    void load_segments(ClipOnDevice& clip, std::vector<Note>& problems);
    ClipOnDevice load_clip(const std::filesystem::path& path, std::vector<Note>& problems);
    std::shared_ptr<const SetEnvironment> load_environment(const stage::Stage& stage);
    std::vector<LoadedLayer> load_layers(const stage::Stage& stage, const stage::StagePerformer& performer,
                                         const voctree::PaintedField& painted);
    void load_paint(const stage::Stage& stage, StageAssets& assets);
    const gpu::Device& device_;
    PaintSource paint_source_;
    PaintFiles paint_files_;
    std::shared_ptr<ClipFiles> files_;
    std::map<std::filesystem::path, KnownHeader> headers_;  // of segments
    std::vector<KnownEnvironment> environments_;            // all that are still in use
};

}  // namespace neuvv::render
