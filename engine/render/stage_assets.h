// Stage assets: what the files of a stage hold, read from the disk and put on the device for a StageRenderer.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/file_stamp.h"
#include "render/field.h"
#include "render/paint_files.h"
#include "render/set_raster.h"
#include "stage/stage.h"

namespace neuvv::render {

// A clip's file, on the device.
struct LoadedClip {
    std::filesystem::path path;
    FileStamp stamp;
    Field field;
    voctree::PaintedField painted;
};

// A layer of paint as a performer shows it.
struct LoadedLayer {
    std::shared_ptr<const voctree::EditLayer> edits;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
    auto operator<=>(const LoadedLayer&) const = default;
};

struct StageAssets {
    std::vector<std::shared_ptr<const LoadedClip>> clips;  // as Stage::clips
    std::shared_ptr<const SetEnvironment> environment;     // dark where the stage has none
    std::vector<std::vector<LoadedLayer>> paint;           // by performer: the layers that show, the lowest first
};

// Reads the files of a stage, and of its next versions only what is new: whatever somebody still has of an earlier
// load, of a file that is as it was, is not read again.
class StageLoader {
  public:
    // Called with what has been read of how many clips.
    using Loaded = std::function<void(size_t, size_t)>;

    // The device must outlive it and all that it loads. Layers for which the source has a pointer are not read.
    explicit StageLoader(const gpu::Device& device, PaintSource paint = {});

    // `loaded` counts clips that are read. Throws InputError for files that cannot be read and RuntimeFailure where the
    // device has no room.
    StageAssets load(const stage::Stage& stage, const Loaded& loaded = {});

  private:
    struct KnownEnvironment {
        std::filesystem::path path;  // empty: none
        FileStamp stamp;
        std::weak_ptr<const SetEnvironment> map;
    };
    std::shared_ptr<const LoadedClip> find_clip(const std::filesystem::path& path, const FileStamp& stamp) const;
    std::vector<std::shared_ptr<const LoadedClip>> load_clips(const stage::Stage& stage, const Loaded& loaded);
    std::shared_ptr<const SetEnvironment> load_environment(const stage::Stage& stage);
    std::vector<LoadedLayer> load_layers(const stage::Stage& stage, const stage::StagePerformer& performer,
                                         const LoadedClip& clip);
    const gpu::Device& device_;
    PaintSource paint_source_;
    PaintFiles paint_files_;
    std::vector<std::weak_ptr<const LoadedClip>> clips_;  // all that live
    std::vector<KnownEnvironment> environments_;          // likewise
};

}  // namespace neuvv::render
