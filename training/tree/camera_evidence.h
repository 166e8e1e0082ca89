// What the mattes of one time say of the cameras: which of them deny matter behind the foreground of the others.
#pragma once

#include <optional>
#include <vector>

#include "training/data/dataset.h"
#include "training/tree/misfits.h"
#include "training/tree/silhouettes.h"

namespace neuvv::training {

// The mattes of all images at a small size. A pixel is foreground, or ignored, where any of the pixels in it is.
Dataset small_mattes(const Dataset& dataset);

// The box in which cells are judged. It is wider than the one of the files, which may leave out a part of the
// performer.
std::pair<glm::dvec3, glm::dvec3> judged_box(const Dataset& dataset);

class CameraEvidence {
  public:
    // The data set must outlive it. At most `most_wrong` images may be wrong.
    CameraEvidence(const Dataset& dataset, double time, const std::pair<glm::dvec3, glm::dvec3>& box,
                   size_t most_wrong);

    // How trusted cameras fit to each other; nothing for others, and for those without an image. By camera. Without
    // blame, `denied` is 0, which takes a fraction of the time.
    std::vector<std::optional<CameraFit>> judge(const std::vector<bool>& trusted, bool blame) const;
    // The share of the foreground in the image of camera `from` that trusted cameras leave unexplained, if camera `at`
    // had taken it. Nothing where one of them has no image, or images of another size.
    std::optional<double> unexplained_at(uint32_t from, uint32_t at, const std::vector<bool>& trusted) const;

  private:
    // A cell, and the images that deny matter there: they show background. Images are numbered as the silhouettes.
    struct DeniedCell {
        HullCell cell{};
        std::vector<uint16_t> by;
        size_t witnesses = 0;  // the images that show matter, and the whole cell
    };
    static std::pair<glm::dvec3, glm::dvec3> box_around_body(const std::vector<DeniedCell>& cells);
    std::vector<DeniedCell> cells_in(const std::vector<HullCell>& cells, size_t most) const;
    // The foreground pixels of an image behind which no cell is possible, if the camera of image `at` had taken it.
    std::vector<size_t> unexplained_pixels_of(size_t from, size_t at, const std::vector<bool>& trusted) const;
    void blame_deniers(size_t of, const std::vector<size_t>& unexplained,
                       const std::vector<std::vector<uint16_t>>& deniers, std::vector<double>& denied) const;
    bool says_something(size_t image) const;
    uint32_t camera_of(size_t image) const { return dataset_->views[silhouettes_[image].view].camera; }

    const Dataset* dataset_;
    std::vector<Silhouette> silhouettes_;
    // Those that few enough images deny: first the narrow grid's, around what most images see, then those around it.
    std::vector<DeniedCell> cells_;
    size_t narrow_cells_ = 0;
    std::vector<std::vector<bool>> meets_narrow_;  // by image, for each pixel: whether its ray meets the narrow grid
    std::vector<size_t> foreground_;               // by image: pixels
};

}  // namespace neuvv::training
