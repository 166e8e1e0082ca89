// One layer that is being painted by one operation, whoever paints: the command line, the mouse or a hand.
//
//     open performer ─► operation ─► touches, regions or a projection ─► layer
//
// What has been selected so far adds up; layer() is the layer with all of it, the same as if all had come at once. A
// session goes over what the subject shows: what it paints itself does not change what it meets.
#pragma once

#include <filesystem>
#include <map>

#include "editor/paint_operation.h"
#include "editor/paint_surface.h"

namespace neuvv::editor {

// Where it is painted: performer's space, metres.
struct PaintArea {
    edit::Region within;                      // leaves outside are not painted; null: none is outside
    float radius_m = 0.05f, hardness = 0.7f;  // of a brush, whose touches select leaves
    // Of a projection: the image, its camera (of the image's size), and whether it falls onto each whole frame as it is
    // then instead of onto the subject's frame alone.
    media::Image image;
    stage::Camera image_camera;
    bool every_frame = false;
};

class PaintSession {
  public:
    // `before` is the layer that is painted.
    PaintSession(PaintSubject subject, std::shared_ptr<const voctree::EditLayer> before, PaintOperation operation,
                 PaintArea area = {});

    // Selects the leaves of a region that the operation is for, whole. False where it selects nothing new. Bound by
    // memory: it reads all leaves' middles, 12 bytes each.
    bool add_region(const edit::Region& region);
    // Selects what the brush covers along a line through these pixels, which goes on from the last call's; from another
    // camera it begins anew.
    void add_touches(PaintSurface& surface, const stage::Camera& camera, std::span<const glm::dvec2> pixels);
    // Projects the image onto one frame. False when all are done; at least one call is needed. Its colours and opacity
    // are the image's times the operation's.
    bool add_projection(PaintSurface& surface);
    // The whole frames that add_projection goes through with `every_frame`: none where first > last.
    std::pair<uint32_t, uint32_t> projected_frames() const;

    // Null as long as nothing is selected.
    std::shared_ptr<const voctree::EditLayer> layer() const;

  private:
    PaintSubject subject_;
    std::shared_ptr<const voctree::EditLayer> before_;
    PaintOperation operation_;
    PaintArea area_;
    std::vector<SelectedLeaf> selected_;  // in order of leaves
    // Of touches.
    glm::dmat4 last_world_from_camera_{0};
    std::optional<glm::dvec2> last_pixel_;
    // Of a projection.
    uint32_t next_frame_ = 0, last_frame_ = 0;
    std::vector<voctree::LeafEdit> projected_;
};

// A performer's clip and layers, read from the disk.
struct ReadPerformer {
    std::shared_ptr<const PaintClip> clip;
    std::map<std::filesystem::path, std::shared_ptr<const voctree::EditLayer>> layers;
};
// Reads the clip, unless it is given, and the layers. Seconds for a large one. Throws InputError.
ReadPerformer read_performer(const std::filesystem::path& clip_path, std::shared_ptr<const PaintClip> clip,
                             std::span<const std::filesystem::path> layers);

// An image whose pixels are means of so many by so many of the other's; the last ones of fewer.
media::Image downscaled(const media::Image& image, uint32_t factor);

}  // namespace neuvv::editor
