// Stage renderer: everything of a stage on the device, to be drawn at any instant from any cameras.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "render/frame.h"
#include "render/linear_picture.h"
#include "stage/stage_instant.h"

namespace neuvv {

class StageRenderer {
  public:
    // Reads the clips, their paint and the environment; calls `loaded` with what has been read of how many files. The
    // stage must outlive it. Throws InputError for files that cannot be read and RuntimeFailure where the device has no
    // room.
    StageRenderer(const Device& device, const Stage& stage, const FrameCapacity& capacity,
                  const std::function<void(size_t, size_t)>& loaded = {});

    // Puts set and lights to an instant of the stage. Its environment shines even where it is not shown, behind all.
    void show(const StageInstant& instant, bool show_environment = true);
    // What a frame of that instant draws: visible performers, blending, lights and background as the stage has them.
    FrameSettings settings_at(const StageInstant& instant) const;

    // The last picture of one view as linear light and depth, set included.
    LinearImage linear_picture_of(const Camera& camera, const glm::vec4& background) const;

    FrameRenderer& frames() { return *frames_; }
    const SetRaster& set() const { return *set_; }
    std::span<const Field> fields() const { return fields_; }  // as Stage::clips

  private:
    uint32_t add_paint(const StagePerformer& performer);
    const Device& device_;
    const Stage& stage_;
    FrameCapacity capacity_;
    std::vector<Field> fields_;
    std::vector<PaintedField> painted_;                // by clip
    std::vector<uint32_t> paints_;                     // by performer: of its clip's Paints
    std::map<std::string, uint32_t> paint_of_layers_;  // copies share it
    std::unique_ptr<SetRaster> set_;
    std::unique_ptr<FrameRenderer> frames_;
};

// The stage's light as raster and rays take it.
SetLight set_light(const InstantLight& light);

}  // namespace neuvv
