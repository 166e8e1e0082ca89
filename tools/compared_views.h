// Views of a clip by which a smaller copy of it is compared with it: an orbit around its leaves while it plays.
#pragma once

#include <span>
#include <vector>

#include "gpu/device.h"
#include "media/exr.h"
#include "media/image.h"
#include "tools/view_path.h"
#include "voctree/slice_paint.h"
#include "voctree/voctree.h"

namespace neuvv::tools {

class ComparedViews {
  public:
    // `count` views in the centres of equal parts of the orbit around the tree. The device must outlive it.
    ComparedViews(const gpu::Device& device, const voctree::VOctree& tree, media::ImageSize size, uint32_t count);

    // Images on white of a clip under layers of paint, the lowest first, each at the frame that its view has.
    std::vector<media::Image> render(const voctree::VOctree& tree,
                                     std::span<const voctree::PaintStep> paint = {}) const;
    // One image of a tree of one frame, as view `i` sees it.
    media::Image render_still(const voctree::VOctree& tree, size_t i,
                              const glm::vec3& background = glm::vec3(1)) const {
        return render(tree, {}, {{views_[i].camera, 0}}, background)[0];
    }
    // The same for a camera of the caller's, of images of the same size.
    media::Image render_still(const voctree::VOctree& tree, const stage::Camera& camera) const;
    // The same as light and depth, without a background.
    media::LinearImage light_of_still(const voctree::VOctree& tree, size_t i) const;
    double frame_of(size_t i) const { return views_[i].frame; }
    const stage::Camera& camera_of(size_t i) const { return views_[i].camera; }
    // Shows whole frames in the views from now on.
    void round_frames();
    size_t count() const { return views_.size(); }

  private:
    std::vector<media::Image> render(const voctree::VOctree& tree, std::span<const voctree::PaintStep> paint,
                                     const std::vector<ViewStep>& views, const glm::vec3& background) const;
    const gpu::Device& device_;
    media::ImageSize size_;
    std::vector<ViewStep> views_;
};

// Whether at least a thousandth of an image differs from its background, which is white or black: the PSNR of images
// that show nothing is high.
bool shows_something(const media::Image& image, const glm::vec3& background);

// The lowest PSNR of images, in dB, against the truth.
double worst_psnr(const std::vector<media::Image>& truth, const std::vector<media::Image>& images);

// The PSNR, in dB, of images of one size together, from that of each: their errors are averaged, not their decibels.
double psnr_together(std::span<const double> psnrs);

}  // namespace neuvv::tools
