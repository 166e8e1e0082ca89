// What is painted on, on the render thread: a performer's field on host and device, as it shows at a frame. Strokes and
// projections go on over several tasks.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "edit/project.h"
#include "editor/paint_operation.h"

namespace neuvv::editor {

// A field on the host, as painting reads it. A large one takes seconds to make.
struct PaintClip {
    explicit PaintClip(voctree::VOctree read)
        : tree(std::move(read)), field(voctree::painted_field(tree)), canvas(tree) {}
    PaintClip(const PaintClip&) = delete;
    PaintClip& operator=(const PaintClip&) = delete;
    voctree::VOctree tree;
    voctree::PaintedField field;
    edit::Canvas canvas;
};

struct WornLayer {
    std::shared_ptr<const voctree::EditLayer> layer;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
    bool operator==(const WornLayer&) const = default;
};

// What is painted on.
struct PaintSubject {
    std::shared_ptr<const PaintClip> clip;
    std::shared_ptr<const render::Field> field;  // the same on the device
    float frame = 0;
    std::vector<WornLayer> paint;  // that shows, the lowest first
    bool operator==(const PaintSubject&) const = default;
};

class PaintSurface {
  public:
    explicit PaintSurface(const gpu::Device& device) : device_(device) {}

    // The subject until the next call; nothing is done where it is the same. Throws RuntimeFailure where the device has
    // no room.
    void show(const PaintSubject& subject);
    // Frees everything.
    void clear();

    // Of the subject; there must be one. Cameras are in the performer's space (in_performer).
    const edit::Canvas& canvas() const { return subject_.clip->canvas; }
    std::span<const float> sigma() const { return sigma_; }  // densities
    render::Picker& picker() { return *picker_; }
    // The point of the surface that a pixel shows, in the performer's space.
    std::optional<glm::dvec3> surface_at(const stage::Camera& camera, glm::dvec2 pixel);

  private:
    const gpu::Device& device_;
    PaintSubject subject_;
    std::vector<float> sigma_;
    std::unique_ptr<render::Picker> picker_;  // of subject_.field
};

// A stroke of a brush, as long as the hand goes on with it. It goes over what the subject shows: what it paints itself
// does not change what it meets.
class Stroke {
  public:
    // `before`: the layer that is painted.
    Stroke(PaintSubject subject, std::shared_ptr<const voctree::EditLayer> before, const PaintOperation& operation,
           float radius_m, float hardness)
        : subject_(std::move(subject)), before_(std::move(before)), operation_(operation), tip_{radius_m, hardness} {}

    // On to these places in the picture, along a straight line from each to the next; from another camera it begins
    // anew. The layer with the stroke as it is now, null as long as it met nothing: the same as if all places had come
    // at once.
    std::shared_ptr<const voctree::EditLayer> add(PaintSurface& surface, const stage::Camera& camera,
                                                  std::span<const glm::dvec2> places);

  private:
    PaintSubject subject_;
    std::shared_ptr<const voctree::EditLayer> before_;
    PaintOperation operation_;
    edit::Brush tip_;  // of a whole alpha, so that an edit's alpha is what is covered
    glm::dmat4 seen_from_{0};
    std::optional<glm::dvec2> last_;
    std::vector<SelectedLeaf> covered_;  // in order of leaves
};

// A picture that is projected: onto the subject's frame, its edits held at frames; or onto each whole frame as it is
// then, frame by frame, so that other work comes between.
class Projection {
  public:
    struct Settings {
        media::Image image;
        stage::Camera camera;  // of the image's size, in the performer's space
        float opacity = 1;
        edit::EditFrames frames;
        bool every_frame = false;
    };
    Projection(PaintSubject subject, std::shared_ptr<const voctree::EditLayer> before, Settings settings);

    // A frame of it. False: it is done.
    bool step(PaintSurface& surface);
    // When it is done; null where it met nothing.
    std::shared_ptr<const voctree::EditLayer> layer() const;

  private:
    PaintSubject subject_;
    std::shared_ptr<const voctree::EditLayer> before_;
    Settings settings_;
    uint32_t next_ = 0, last_ = 0;  // frames, where each is painted
    std::vector<voctree::LeafEdit> edits_;
};

// A picture whose pixels are means of so many by so many of the other's; the last ones of fewer.
media::Image reduced(const media::Image& image, uint32_t factor);

}  // namespace neuvv::editor
