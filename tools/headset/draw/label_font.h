// Labels in the stage: lines of text on a dark plate, in the panel's font.
#pragma once

#include <imgui.h>

#include <span>
#include <string_view>

#include "gpu/image.h"
#include "xr/draw/eye_shapes.h"

namespace neuvv::headset {

class LabelFont {
  public:
    // Copies the image of the first font of ImGui's present context. The context must outlive this object.
    explicit LabelFont(const gpu::Device& device);
    ~LabelFont();
    LabelFont(const LabelFont&) = delete;
    LabelFont& operator=(const LabelFont&) = delete;
    const gpu::DeviceImage& image() const { return image_; }

    // Adds lines of text on a plate to the shapes. The plate's lower centre is at the pose's origin, X to its right and
    // Y up; `line_m` is the height of a line. Lines are UTF-8; of each line, the first kMaxLetters are shown.
    static constexpr int kMaxLetters = 32;
    void draw(xr::EyeShapes& shapes, const xr::Pose& world_from_plate, double line_m,
              std::span<const std::string_view> lines) const;

  private:
    double width_of(std::string_view line) const;  // in pixels of the font
    gpu::DeviceImage image_;
    const ImFont* font_ = nullptr;
    xr::FontPart plate_;  // where all of the image is covered
};

}  // namespace neuvv::headset
