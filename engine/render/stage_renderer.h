// Stage renderer: everything of a stage on the device, to be drawn at any instant from any cameras, while the stage is
// edited and its files are written anew.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "render/file_stamp.h"
#include "render/frame.h"
#include "render/linear_picture.h"
#include "render/paint_files.h"
#include "stage/stage_instant.h"

namespace neuvv::render {

class StageRenderer {
  public:
    // Called with what has been read of how many clips.
    using Loaded = std::function<void(size_t, size_t)>;

    // Reads the clips, their paint and the environment. The stage must outlive it, or be replaced by change(). Throws
    // InputError for files that cannot be read and RuntimeFailure where the device has no room.
    StageRenderer(const gpu::Device& device, const stage::Stage& stage, const FrameCapacity& capacity,
                  const Loaded& loaded = {}, PaintSource paint = {});

    // From now on it draws this stage, another object than the one before, which may go after the call. Then show() an
    // instant of it. Only what differs is read and uploaded: clips, environment and layers by path whose file is not as
    // it was, layers for which the paint source has another pointer, and the set where it does not have the same
    // vertices, textures and materials. Clips that nobody plays any more are dropped; one that somebody still has
    // (shared_field) is not read again when it comes back. `loaded` counts clips that are read. Throws as the
    // constructor does, and then draws the stage before as if nothing had been asked.
    void change(const stage::Stage& stage, const Loaded& loaded = {});

    // What settings_at asks for. Larger pictures than ever before need other targets (frames() is another then, which
    // has drawn nothing yet); fields, slices, paint and set stay. Throws RuntimeFailure where the device has no room,
    // and then keeps its size.
    void resize(uint32_t width, uint32_t height);

    // Puts set and lights to an instant of the stage. Its environment shines even where it is not shown, behind all.
    void show(const stage::StageInstant& instant, bool show_environment = true);
    // What a frame of that instant draws: visible performers, blending, lights and background as the stage has them.
    // A part of the picture is a picture of its own: a smaller width and height, and a camera whose principal point is
    // moved as far. It may have more samples than the capacity while samples · width and samples · height do not exceed
    // the capacity's. Parts make the whole within a step of 255, but for pixels at edges of the set.
    FrameSettings settings_at(const stage::StageInstant& instant) const;

    // What of each view's picture nobody sees (SetRaster::hide), until it is called again.
    void hide(std::span<const std::vector<glm::vec2>> corners) { set_->hide(corners); }

    // The last picture of one view, of settings_at's size and samples, as linear light and depth, set included.
    media::LinearImage linear_picture_of(const stage::Camera& camera, const glm::vec4& background) const;

    FrameRenderer& frames() { return *frames_; }
    const FrameRenderer& frames() const { return *frames_; }
    const SetRaster& set() const { return *set_; }
    // Of Stage::clips, until the next change().
    const Field& field(uint32_t clip) const { return clips_[clip]->field; }
    // The same, which stays for as long as somebody has it.
    std::shared_ptr<const Field> shared_field(uint32_t clip) const { return {clips_[clip], &clips_[clip]->field}; }
    const voctree::PaintedField& painted_field(uint32_t clip) const { return clips_[clip]->painted; }
    // What a performer of the stage is painted with, of its clip's frames().paints(); 0: nothing.
    uint32_t paint_of(uint32_t performer) const { return paints_[performer]; }

  private:
    struct Clip {
        std::filesystem::path path;
        FileStamp stamp;
        Field field;
        voctree::PaintedField painted;
    };
    struct Around {
        std::filesystem::path path;  // empty: none
        FileStamp stamp;
        std::shared_ptr<const SetEnvironment> map;
    };
    // The layers of a performer that show, the lowest first; performers for whom all is equal share a paint.
    struct PaintKey {
        std::shared_ptr<const Clip> clip;
        std::vector<std::tuple<std::shared_ptr<const voctree::EditLayer>, stage::PaintBlend, float>> layers;
        auto operator<=>(const PaintKey&) const = default;
    };
    struct NextPaints {
        std::vector<PaintKey> of_performer;
        std::map<PaintKey, Paint> made;  // those that are not on the device yet
    };
    using Clips = std::vector<std::shared_ptr<const Clip>>;
    Clips load_clips(const stage::Stage& stage, const Loaded& loaded);
    std::shared_ptr<const Clip> find_clip(const std::filesystem::path& path, const FileStamp& stamp) const;
    Around load_around(const stage::Stage& stage) const;
    PaintKey paint_key(const stage::Stage& stage, const stage::StagePerformer& performer,
                       const std::shared_ptr<const Clip>& clip);
    NextPaints make_paints(const stage::Stage& stage, const Clips& clips);
    void take(const stage::Stage& stage, NextPaints next);
    void make_targets(uint32_t width, uint32_t height);
    const gpu::Device& device_;
    const stage::Stage* stage_;
    FrameCapacity capacity_;  // of what is asked for; the set's size says for how much there is room
    PaintSource paint_source_;
    PaintFiles paint_files_;
    Clips clips_;                                  // as Stage::clips
    std::vector<std::weak_ptr<const Clip>> read_;  // all that live
    Around around_;
    std::map<PaintKey, uint32_t> paint_numbers_;
    std::vector<uint32_t> paints_;  // by performer
    std::unique_ptr<SetRaster> set_;
    std::unique_ptr<FrameRenderer> frames_;
};

// The stage's light as raster and rays take it.
SetLight set_light(const stage::InstantLight& light);

}  // namespace neuvv::render
