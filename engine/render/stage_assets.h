// Stage assets: the contents of a stage's files, read from the disk and uploaded to the device for a StageRenderer.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/file_stamp.h"
#include "render/field_levels.h"
#include "render/paint_files.h"
#include "render/set_raster.h"
#include "stage/stage.h"
#include "voctree/clip_index.h"

namespace neuvv::render {

// A clip's file on the device; of a segmented clip, that of a segment.
struct LoadedClip {
    std::filesystem::path path;
    FileStamp stamp;
    Field field;
    voctree::PaintedField painted;
};

// A clip on the device.
struct ClipOnDevice {
    voctree::ClipIndex index;
    // In the order of the index; a file is one segment. Null where a segment cannot be read; one of them can.
    std::vector<std::shared_ptr<const LoadedClip>> segments;
    const std::shared_ptr<const LoadedClip>& first_readable() const;
};

// A visible layer of a performer's paint.
struct LoadedLayer {
    std::shared_ptr<const voctree::EditLayer> edits;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
    auto operator<=>(const LoadedLayer&) const = default;
};

struct StageAssets {
    std::vector<ClipOnDevice> clips;                    // in the order of Stage::clips
    std::shared_ptr<const SetEnvironment> environment;  // black where the stage has none
    std::vector<std::vector<LoadedLayer>> paint;        // by performer: the visible layers, the lowest first
    std::vector<std::string> problems;                  // a line for each segment that cannot be read
};

// Reads the files of a stage, and of its later versions only what has changed: an asset of an earlier load that is
// still in use, and whose file has not changed, is not read again.
class StageLoader {
  public:
    // Called after each file of a clip that was read, with the number of files read so far and the number to be read.
    using Loaded = std::function<void(size_t, size_t)>;

    // The device must outlive the loader and all that it loads. Layers that `paint` returns are not read from the disk.
    explicit StageLoader(const gpu::Device& device, PaintSource paint = {});

    // Throws InputError for a file that cannot be read, for a segmented clip of which no segment can be, and for paint
    // of another clip or of a segmented one; RuntimeFailure where the device has no memory.
    StageAssets load(const stage::Stage& stage, const Loaded& loaded = {});

  private:
    struct KnownEnvironment {
        std::filesystem::path path;  // empty: none
        FileStamp stamp;
        std::weak_ptr<const SetEnvironment> map;
    };
    std::shared_ptr<const LoadedClip> find_clip(const std::filesystem::path& path, const FileStamp& stamp) const;
    std::shared_ptr<const LoadedClip> load_segment(const voctree::ClipSegment& segment);
    std::vector<ClipOnDevice> load_clips(const stage::Stage& stage, const Loaded& loaded,
                                         std::vector<std::string>& problems);
    std::shared_ptr<const SetEnvironment> load_environment(const stage::Stage& stage);
    std::vector<LoadedLayer> load_layers(const stage::Stage& stage, const stage::StagePerformer& performer,
                                         const ClipOnDevice& clip);
    const gpu::Device& device_;
    PaintSource paint_source_;
    PaintFiles paint_files_;
    std::vector<std::weak_ptr<const LoadedClip>> clips_;  // all that are still in use
    std::vector<KnownEnvironment> environments_;          // likewise
};

}  // namespace neuvv::render
