// Stage renderer: everything of a stage on the device, to be drawn at any time from any cameras, while the stage is
// edited and its files are written anew.
#pragma once

#include <map>

#include "render/frame.h"
#include "render/linear_image.h"
#include "render/stage_assets.h"
#include "stage/evaluated_stage.h"

namespace neuvv::render {

class StageRenderer {
  public:
    // `assets`: what a StageLoader has read of this stage. The stage must outlive it, or be replaced by change().
    // Throws RuntimeFailure where the device has no room.
    StageRenderer(const gpu::Device& device, const stage::Stage& stage, StageAssets assets,
                  const FrameCapacity& capacity);

    // From now on it draws this stage, another object than the one before, which may go after the call. Then show() an
    // time of it. Only what differs is uploaded: layers that are other objects than before, and the set where it
    // does not have the same vertices, textures and materials. Clips that nobody plays any more are dropped; one that
    // somebody still has (shared_field) is not read again when it comes back. Throws as the constructor does, and then
    // draws the stage before as if nothing had been asked.
    void change(const stage::Stage& stage, StageAssets assets);

    // What settings_at asks for. Larger images than ever before need other targets (frames() is another then, which
    // has drawn nothing yet); fields, slices, paint and set stay. Throws RuntimeFailure where the device has no room,
    // and then keeps its size.
    void resize(uint32_t width, uint32_t height);

    // Puts set and lights to a time of the stage. Its environment shines even where it is not shown, behind all.
    void show(const stage::EvaluatedStage& evaluated, bool show_environment = true);
    // What a frame of that time draws: visible performers, blending, lights and background as the stage has them.
    // A part of the image is an image of its own: a smaller width and height, and a camera whose principal point is
    // moved as far. It may have more samples than the capacity while samples · width and samples · height do not exceed
    // the capacity's. Parts make the whole within a step of 255, but for pixels at edges of the set.
    FrameSettings settings_at(const stage::EvaluatedStage& evaluated) const;

    // What of each view's image nobody sees (SetRaster::hide), until it is called again.
    void hide(std::span<const std::vector<glm::vec2>> corners) { set_->hide(corners); }

    // The last image of one view, of settings_at's size and samples, as linear light and depth, set included.
    media::LinearImage linear_image_of(const stage::Camera& camera, const glm::vec4& background) const;

    FrameRenderer& frames() { return *frames_; }
    const FrameRenderer& frames() const { return *frames_; }
    const SetRaster& set() const { return *set_; }
    // Of Stage::clips, until the next change().
    const Field& field(uint32_t clip) const { return assets_.clips[clip]->field; }
    // The same, which stays for as long as somebody has it.
    std::shared_ptr<const Field> shared_field(uint32_t clip) const {
        return {assets_.clips[clip], &assets_.clips[clip]->field};
    }
    const voctree::PaintedField& painted_field(uint32_t clip) const { return assets_.clips[clip]->painted; }
    // What a performer of the stage is painted with, of its clip's frames().paints(); 0: nothing.
    uint32_t paint_of(uint32_t performer) const { return paints_[performer]; }

  private:
    // Performers for whom all is equal share a paint.
    struct PaintKey {
        std::shared_ptr<const LoadedClip> clip;
        std::vector<LoadedLayer> layers;
        auto operator<=>(const PaintKey&) const = default;
    };
    struct NextPaints {
        std::vector<PaintKey> of_performer;
        std::map<PaintKey, Paint> new_paints;  // those that are not on the device yet
    };
    NextPaints make_paints(const stage::Stage& stage, const StageAssets& assets) const;
    void apply_paints(const stage::Stage& stage, NextPaints next);
    void make_targets(uint32_t width, uint32_t height);
    const gpu::Device& device_;
    const stage::Stage* stage_;
    FrameCapacity capacity_;  // of what is asked for; the set's size says for how much there is room
    StageAssets assets_;
    std::map<PaintKey, uint32_t> paint_numbers_;
    std::vector<uint32_t> paints_;  // by performer
    std::unique_ptr<SetRaster> set_;
    std::unique_ptr<FrameRenderer> frames_;
};

// The stage's light as raster and rays take it.
SetLight set_light(const stage::EvaluatedLight& light);

}  // namespace neuvv::render
