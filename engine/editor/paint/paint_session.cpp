#include "editor/paint/paint_session.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "voctree/files/clip.h"
#include "voctree/files/nvpaint.h"
#include "voctree/kinds/clip_source.h"

namespace neuvv::editor {

namespace {

// The union of two lists in order of leaves. A leaf that is in both gets the larger share.
std::vector<SelectedLeaf> united(const std::vector<SelectedLeaf>& a, const std::vector<SelectedLeaf>& b) {
    std::vector<SelectedLeaf> all;
    all.reserve(a.size() + b.size());
    auto next = a.begin();
    for (const SelectedLeaf& one : b) {
        for (; next != a.end() && next->leaf < one.leaf; ++next) all.push_back(*next);
        const bool known = next != a.end() && next->leaf == one.leaf;
        all.push_back({one.leaf, known ? std::max(next->share, one.share) : one.share});
        if (known) ++next;
    }
    all.insert(all.end(), next, a.end());
    return all;
}

}  // namespace

PaintSession::PaintSession(PaintSubject subject, std::shared_ptr<const voctree::EditLayer> before,
                           PaintOperation operation, PaintArea area)
    : subject_(std::move(subject)), before_(std::move(before)), operation_(operation), area_(std::move(area)) {
    if (area_.every_frame) std::tie(next_frame_, last_frame_) = projected_frames();
}

bool PaintSession::add_region(const edit::Region& region) {
    const edit::Canvas& canvas = subject_.clip->canvas;
    const edit::Region where = area_.within ? edit::both(region, area_.within) : region;
    const size_t before = selected_.size();
    selected_ = united(selected_, leaves_for(canvas, *before_, where, operation_));
    return selected_.size() > before;
}

// The line to the first new pixel begins again at the last pixel. That touch lies on the stroke already and covers
// nothing new. The brush's alpha is 1, so the alpha of an edit is the covered share of the leaf.
void PaintSession::add_touches(PaintSurface& surface, const stage::Camera& camera, std::span<const glm::dvec2> pixels) {
    surface.show(subject_);
    if (camera.world_from_camera != last_world_from_camera_) last_pixel_.reset();
    last_world_from_camera_ = camera.world_from_camera;
    std::vector<glm::dvec2> line;
    if (last_pixel_) line.push_back(*last_pixel_);
    line.insert(line.end(), pixels.begin(), pixels.end());
    if (line.empty()) return;
    last_pixel_ = line.back();
    const edit::Canvas& canvas = surface.canvas();
    const std::vector<edit::Touch> touches = edit::touches_under(surface.picker(), camera, line);
    std::vector<SelectedLeaf> covered;
    for (const voctree::LeafEdit& edit :
         edit::stroke(canvas, surface.sigma(), {area_.radius_m, area_.hardness}, touches))
        if (!area_.within || area_.within(canvas.centres[edit.leaf])) covered.push_back({edit.leaf, edit.alpha});
    selected_ = united(selected_, covered);
}

std::pair<uint32_t, uint32_t> PaintSession::projected_frames() const {
    const edit::EditFrames& frames = operation_.frames;
    if (frames.first > frames.last) return {1, 0};
    return {static_cast<uint32_t>(std::ceil(frames.first)), static_cast<uint32_t>(frames.last)};
}

bool PaintSession::add_projection(PaintSurface& surface) {
    if (next_frame_ > last_frame_) return false;
    if (area_.every_frame) subject_.frame = static_cast<float>(next_frame_);
    surface.show(subject_);
    const edit::Canvas& canvas = surface.canvas();
    std::vector<voctree::LeafEdit> edits =
        edit::project(surface.picker(), canvas, surface.sigma(), area_.image, area_.image_camera);
    if (area_.within)
        std::erase_if(edits, [&](const voctree::LeafEdit& edit) { return !area_.within(canvas.centres[edit.leaf]); });
    for (voctree::LeafEdit& edit : edits) {
        edit.alpha *= operation_.opacity;
        edit.first = edit.last = subject_.frame;
    }
    if (area_.every_frame)
        projected_.insert(projected_.end(), edits.begin(), edits.end());
    else
        projected_ = edit::at_frames(canvas, edits, operation_.frames);
    return next_frame_++ < last_frame_;
}

std::shared_ptr<const voctree::EditLayer> PaintSession::layer() const {
    if (projected_.empty()) return apply_operation(subject_.clip->canvas, *before_, selected_, operation_);
    auto after = std::make_shared<voctree::EditLayer>(*before_);
    const edit::EditFrames& frames = operation_.frames;
    voctree::add_edits(
        *after, area_.every_frame ? edit::extend_between_frames(projected_, frames.first, frames.last) : projected_);
    return after;
}

ReadPerformer read_performer(const PaintPlace& place, std::shared_ptr<const PaintClip> clip,
                             std::span<const std::filesystem::path> layers) {
    const voctree::ClipSegment& segment = place.segment();
    segment.source->expect_paintable();
    ReadPerformer read;
    read.clip = clip ? std::move(clip) : std::make_shared<const PaintClip>(voctree::read_segment(segment));
    for (const std::filesystem::path& layer : layers)
        read.files[place.layer_file(layer)] = std::make_shared<const voctree::EditLayer>(
            place.is_segmented() ? voctree::read_segment_paint(layer, segment, read.clip->field)
                                 : voctree::read_paint(layer, read.clip->field));
    return read;
}

media::Image downscaled(const media::Image& image, uint32_t factor) {
    if (factor <= 1) return image;
    media::Image small((image.width + factor - 1) / factor, (image.height + factor - 1) / factor);
    for (uint32_t y = 0; y < small.height; ++y)
        for (uint32_t x = 0; x < small.width; ++x) {
            glm::vec4 sum(0);  // premultiplied, linear
            float count = 0;
            for (uint32_t row = y * factor; row < std::min((y + 1) * factor, image.height); ++row)
                for (uint32_t column = x * factor; column < std::min((x + 1) * factor, image.width); ++column) {
                    const uint8_t* rgba = image.at(column, row);
                    const float alpha = static_cast<float>(rgba[3]) / 255;
                    const glm::vec3 colour(media::linear_from_srgb_byte(rgba[0]), media::linear_from_srgb_byte(rgba[1]),
                                           media::linear_from_srgb_byte(rgba[2]));
                    sum += glm::vec4(alpha * colour, alpha);
                    ++count;
                }
            uint8_t* to = small.at(x, y);
            for (int c = 0; c < 3; ++c) to[c] = media::srgb_byte_from_linear(sum.a > 0 ? sum[c] / sum.a : 0);
            to[3] = static_cast<uint8_t>(std::lround(255 * sum.a / count));
        }
    return small;
}

}  // namespace neuvv::editor
