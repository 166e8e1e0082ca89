// The images of one camera of a rig as training sees them: without distortion, with their mattes as alpha.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "stage/camera.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/layouts/rig/rig.h"
#include "training/data/undistort.h"

namespace neuvv::training {

struct CameraImage {
    media::Image image;
    std::vector<bool> ignored;  // as View::ignored; their alpha is 0
};

// What RGB is where alpha is 0, in images of a lens that distorts. Elsewhere it is the same.
enum class Background : uint8_t { kAnything, kCaptured };

class CameraImages {
  public:
    // `pinhole`: the camera without distortion, with the size of its images. The rig must outlive the object. All
    // functions throw InputError for images that cannot be read or have another size.
    CameraImages(const Rig& rig, uint32_t camera, const stage::Camera& pinhole);

    const media::Image& plate() const { return plate_; }  // empty where there is none
    CameraImage read(const Shot& shot, Background background = Background::kAnything);

  private:
    Undistortion undistortion() const;
    media::Image read(ImageReader& reader, const ImageSource& source) const;
    void apply_matte_file(const Shot& shot, media::Image& image);

    const Rig& rig_;
    const RigCamera& from_;
    const media::ImageSize size_;
    const std::string whose_;
    std::optional<Undistortion> map_;
    media::Image plate_;
    ImageReader images_, masks_, mattes_;
};

}  // namespace neuvv::training
