// Chooses the resolution of interactive images so that an image takes about its target time.
//
// The model: an image at `scale` times the full width and height takes fixed + full · scale² milliseconds.
#pragma once

#include <cstdint>

namespace neuvv::editor {

constexpr double kMinScale = 0.2;

class DynamicScale {
  public:
    // `scale` is the scale of the first image, kMinScale to 1.
    explicit DynamicScale(double target_ms, double scale = 0.5);

    // The scale of the next image, kMinScale to 1. It goes down as far as it must at once, but up by at most a factor
    // of kMaxGrowth per image. Changes below a share of kMinChange are left out, because an image whose size changes
    // all the time flickers.
    double scale() const { return scale_; }
    static constexpr double kMaxGrowth = 1.15, kMinChange = 0.06;

    // Notes that an image was drawn at this scale in this time. For a block of a larger image, the scale is the square
    // root of the block's share of the work of a full image. Values that are not positive and finite are ignored.
    void drawn(double scale, double milliseconds);

    double target_ms() const { return target_ms_; }
    void set_target(double target_ms) { target_ms_ = target_ms; }

    // The estimated costs; 0 before the first image.
    double fixed_ms() const { return fixed_ms_; }
    double full_ms() const { return full_ms_; }

  private:
    void fit();
    double target_scale() const;

    double target_ms_, scale_;
    double fixed_ms_ = 0, full_ms_ = 0;
    // Sums over the drawn images of 1, x, y, x², xy, with x = scale² and y = milliseconds. Older images weigh less.
    double count_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
};

}  // namespace neuvv::editor
