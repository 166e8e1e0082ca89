// One layer of paint that is being painted by one operation. The command line, the mouse and the hand all paint by it.
//
//     open performer ─► operation ─► touches, regions or a projection ─► layer
//
// Selections add up: layer() is the layer with all selections so far, the same as if all of them had come at once. The
// session paints on the subject as it was at the start: its own paint does not change which leaves it selects.
#pragma once

#include <filesystem>

#include "editor/paint/paint_operation.h"
#include "editor/paint/paint_place.h"
#include "editor/paint/paint_surface.h"

namespace neuvv::editor {

// Where the operation applies, in the performer's space in metres.
struct PaintArea {
    edit::Region within;                      // only leaves with their centres in this region are painted; null: all
    float radius_m = 0.05f, hardness = 0.7f;  // of the brush of add_touches
    // For a projection: the image, and a camera of the image's size. With `every_frame` the image is projected onto
    // each whole frame of the operation, as the performer is then; without, onto the subject's frame alone.
    media::Image image;
    stage::Camera image_camera;
    bool every_frame = false;
};

class PaintSession {
  public:
    // `before` is the layer as it is before the session.
    PaintSession(PaintSubject subject, std::shared_ptr<const voctree::EditLayer> before, PaintOperation operation,
                 PaintArea area = {});

    // Selects all leaves of a region that the operation applies to. Returns whether any of them was not selected
    // before. The cost is reading the centres of all leaves, 12 bytes each.
    bool add_region(const edit::Region& region);
    // Selects the leaves that the brush covers along a line through these pixels of the camera's image. The line goes
    // on from the last call where the camera is the same.
    void add_touches(PaintSurface& surface, const stage::Camera& camera, std::span<const glm::dvec2> pixels);
    // Projects the image onto the next frame. Returns false once all frames are done; at least one call is needed. The
    // operation's opacity multiplies the image's alpha.
    bool add_projection(PaintSurface& surface);
    // The first and the last of the frames that add_projection goes through with `every_frame`; none where first >
    // last.
    std::pair<uint32_t, uint32_t> projected_frames() const;

    // The layer with everything that was selected; null while nothing is.
    std::shared_ptr<const voctree::EditLayer> layer() const;

  private:
    PaintSubject subject_;
    std::shared_ptr<const voctree::EditLayer> before_;
    PaintOperation operation_;
    PaintArea area_;
    std::vector<SelectedLeaf> selected_;  // in order of leaves
    // State of add_touches.
    glm::dmat4 last_world_from_camera_{0};
    std::optional<glm::dvec2> last_pixel_;
    // State of add_projection.
    uint32_t next_frame_ = 0, last_frame_ = 0;
    std::vector<voctree::LeafEdit> projected_;
};

// A performer's clip, or a segment of it, and files of its layers, as read from the disk.
struct ReadPerformer {
    std::shared_ptr<const PaintClip> clip;
    voctree::PaintLayers files;
};
// Reads the segment, unless it is given, and its files of these layers (PaintPlace::layer_file). A large clip takes
// seconds. Throws InputError, also for a stream.
ReadPerformer read_performer(const PaintPlace& place, std::shared_ptr<const PaintClip> clip,
                             std::span<const std::filesystem::path> layers);

// The image made smaller: each pixel is the mean of factor × factor pixels, of fewer at the right and lower edges.
media::Image downscaled(const media::Image& image, uint32_t factor);

}  // namespace neuvv::editor
