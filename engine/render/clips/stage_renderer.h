// Stage renderer: a whole stage on the device, to be drawn at any time and from any cameras, while the stage is edited
// and its files are written again.
#pragma once

#include <map>
#include <optional>

#include "render/clips/stage_clips.h"
#include "render/frame/frame_renderer.h"
#include "render/frame/image_layers.h"
#include "render/rays/linear_image.h"

namespace neuvv::render {

// A performer of which parts are red.
struct PerformerHighlight {
    uint32_t performer = 0;                      // index into Stage::performers
    std::shared_ptr<const Highlight> highlight;  // null: none
    // Whether both look the same.
    bool operator==(const PerformerHighlight& other) const {
        if (!highlight || !other.highlight) return highlight == other.highlight;
        return performer == other.performer && *highlight == *other.highlight;
    }
};

class StageRenderer {
  public:
    // `assets` are what a StageLoader has loaded for this stage. The stage must outlive the renderer or be replaced by
    // change(). Throws RuntimeFailure where the device has no memory.
    StageRenderer(const gpu::Device& device, const stage::Stage& stage, const StageAssets& assets,
                  const FrameCapacity& capacity);

    // Replaces the stage by another object; the old one may be destroyed after the call. show() must be called before
    // the next frame. Only what differs is uploaded: layers of paint that are different objects, and the set unless its
    // vertices, textures and materials are the same. Clips that no performer plays any more are dropped; a clip that is
    // still in use elsewhere (shared_field) need not be read again when it returns. Throws as the constructor does, and
    // then still draws the old stage.
    void change(const stage::Stage& stage, const StageAssets& assets);

    // Sets the size of the images that settings_at describes, in pixels. Images that are larger than any before need
    // new targets: frames() then returns another object, which has drawn nothing yet. Fields, slices, paint and set
    // stay. Throws RuntimeFailure where the device has no memory, and then keeps the old size.
    void resize(uint32_t width, uint32_t height);

    // Poses the set, sets its lights and brings segments of clips to the device for a time of the stage.
    // `show_environment` makes the environment visible as the background; the environment gives light in any case.
    // Throws RuntimeFailure where the device has no memory.
    void show(const stage::EvaluatedStage& evaluated, bool show_environment = true,
              MissingSegments missing = MissingSegments::kWait);
    // Where a height is given (world, metres), show() leaves out set and environment until the next call, and
    // performers cast their shadows on a floor at this height (SetRaster::catch_shadows): for headsets that show the
    // user's own room. The environment still gives light. The set casts no shadows on performers then. Where the stage
    // has no lights, half of its ambient light comes from above, so that there is a shadow (none where an image of the
    // environment alone lights it); performers look as without it.
    void show_room(std::optional<double> floor_m) {
        if (floor_m.has_value() != room_floor_m_.has_value()) frames_->finish();
        set_->catch_shadows(floor_m);
        room_floor_m_ = floor_m;
    }
    // The settings of a frame at that time: the visible performers, and the blending, lights and background of the
    // stage. One that fades from a segment of its clip to the next is two instances, where it is
    // opaque, the stage's blending is exact, and all have room. Performers of which the segment is not on the device
    // are as StageClips::place_of says. A part of an image is drawn as an image of smaller width and height, by a
    // camera whose principal point is moved by the part's position. It may have more samples than the capacity as long
    // as samples · width and samples · height do not exceed the capacity's. Parts together equal the whole image within
    // a step of 255, except at edges of the set.
    FrameSettings settings_at(const stage::EvaluatedStage& evaluated, const PerformerHighlight& highlight = {}) const;

    // The instances of all these times, as settings_at has them, so that their slices are made ahead of time.
    std::vector<Instance> instances_at(std::span<const double> times_s) const;

    // StageClips::holds, of the time of the last show().
    bool holds(const stage::EvaluatedStage& evaluated) const { return clips_.holds(evaluated); }
    // What visible performers show at this time: fields, also of coarse trees, and frames of them.
    std::vector<std::pair<const Field*, float>> shown(const stage::EvaluatedStage& evaluated) const;
    bool shows_all(const stage::EvaluatedStage& evaluated) const { return clips_.shows_all(evaluated); }
    // A visible performer as settings_at has it, but whole, in the segment of its time alone; nothing where it is not
    // drawn.
    std::optional<Instance> instance_of(const stage::EvaluatedPerformer& performer) const;

    // Sets the hidden parts of each view's image (SetRaster::hide) until the next call.
    void hide(std::span<const std::vector<glm::vec2>> corners) {
        frames_->finish();
        set_->hide(corners);
    }

    // What the set contributes to the rays of the last image, which must have had one view, and the size and samples of
    // settings_at.
    SetRays set_rays() const;
    // The last image as linear light and depth, set included.
    media::LinearImage linear_image_of(const stage::Camera& camera, const SetRays& set,
                                       const glm::vec4& background) const;

    FrameRenderer& frames() { return *frames_; }
    const FrameRenderer& frames() const { return *frames_; }
    const SetRaster& set() const { return *set_; }
    // The field of a clip (an index into Stage::clips), valid until the next change(); of a segmented clip, that of its
    // first segment that can be read, and of a stream, that of a frame, valid until the next image.
    const Field& field(uint32_t clip) const { return first(clip)->field; }
    // The same field, valid for as long as the pointer exists.
    std::shared_ptr<const Field> shared_field(uint32_t clip) const { return {first(clip), &first(clip)->field}; }
    // The field of the file of a clip or of a segment, where it is on the device and is the one that `painted` was made
    // for; else null. Valid for as long as the pointer exists.
    std::shared_ptr<const Field> find_field(const std::filesystem::path& file,
                                            const voctree::PaintedField& painted) const;
    // Whether the file is that of a segment that is not on the device, but can be read.
    bool awaits(const std::filesystem::path& file) const;
    // One for each segment, and for paint of a segment, that cannot be read, of those that were found since the last
    // call, or since change(): StageClips::problems.
    std::vector<Note> take_problems();
    // ClipOnDevice::leaf_box.
    std::pair<glm::dvec3, glm::dvec3> leaf_box(uint32_t clip) const { return clips_.clips()[clip].leaf_box; }
    // What is solid of a performer in the segment of its time, null where the loader does not find that, and the frame
    // of that segment; nothing where nothing of the performer is shown.
    struct SolidAt {
        std::shared_ptr<const voctree::SolidLeaves> leaves;
        double frame = 0;
    };
    std::optional<SolidAt> solid_of(const stage::EvaluatedPerformer& performer) const;
    // The number of a performer's paint in frames().paints(); 0: no paint, or a segmented clip.
    uint32_t paint_of(uint32_t performer) const { return paints_[performer]; }

  private:
    // Performers with equal keys share a paint. Without layers there is none, and no clip.
    struct PaintKey {
        std::shared_ptr<const LoadedClip> clip;
        std::vector<LoadedLayer> layers;
        auto operator<=>(const PaintKey&) const = default;
    };
    struct NextPaints {
        std::vector<PaintKey> of_performer;
        std::map<PaintKey, Paint> new_paints;  // those that have no number yet
    };
    const std::shared_ptr<const LoadedClip>& first(uint32_t clip) const { return clips_.clips()[clip].first; }
    void update_fields();
    void update_segment_paints();
    Instance instance_at(const stage::EvaluatedPerformer& performer, const StageClips::Place& place) const;
    // Among fields_; their number where it is not among them.
    uint32_t number_of(const Field& field) const;
    NextPaints make_paints(const stage::Stage& stage, const StageAssets& assets) const;
    void apply_paints(const stage::Stage& stage, NextPaints next);
    void bring_to_device(const stage::EvaluatedStage& evaluated, MissingSegments missing);
    void make_targets(uint32_t width, uint32_t height);
    const gpu::Device& device_;
    const stage::Stage* stage_;
    uint64_t lack_budget_;    // of slices, when a segment last found no memory; before that, the first budget
    FrameCapacity capacity_;  // its size is that of settings_at; the set's size is the largest so far
    StageClips clips_;
    size_t reported_problems_ = 0;      // of clips_, by take_problems()
    std::vector<const Field*> fields_;  // of clips_, in the order of FrameRenderer
    uint32_t slice_shares_ = 0;         // FrameRenderer::change_fields
    std::map<PaintKey, uint32_t> paint_numbers_;
    std::vector<uint32_t> paints_;  // by performer; 0 for those on segmented clips
    // The paints of segments that are on the device: their numbers, and the clips whose fields they are on.
    struct NumberedPaint {
        std::weak_ptr<const LoadedClip> clip;
        uint32_t number = 0;
    };
    std::map<std::shared_ptr<const Paint>, NumberedPaint> segment_paints_;
    std::unique_ptr<SetRaster> set_;
    std::optional<double> room_floor_m_;
    bool has_room_lamp_ = false;  // light from above, in a stage without lights
    std::unique_ptr<FrameRenderer> frames_;
};

// A light of the stage in the form that the set's raster and the rays take.
SetLight set_light(const stage::EvaluatedLight& light);

}  // namespace neuvv::render
