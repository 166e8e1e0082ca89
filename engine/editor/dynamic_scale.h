// How large an interactive image may be so that it takes about as long as its target.
//
// An image at `scale` of the full resolution's sides is taken to cost fixed + full · scale² milliseconds.
#pragma once

#include <cstdint>

namespace neuvv::editor {

constexpr double kMinScale = 0.2;

class DynamicScale {
  public:
    // `scale` is that of the first image, kMinScale to 1.
    explicit DynamicScale(double target_ms, double scale = 0.5);

    // Of the next image, kMinScale to 1. It goes down at once as far as it must, up by at most kMaxGrowth an image, and
    // stays as it is while a change would be smaller than kMinChange: sizes that come and go flicker.
    double scale() const { return scale_; }
    static constexpr double kMaxGrowth = 1.15, kMinChange = 0.06;

    // An image was drawn at this scale in this time; also a block of a larger one, whose scale is the root of its
    // share of a full image's work. What is not positive and finite is ignored.
    void drawn(double scale, double milliseconds);

    double target_ms() const { return target_ms_; }
    void set_target(double target_ms) { target_ms_ = target_ms; }

    // What is known of the costs; 0 before the first image.
    double fixed_ms() const { return fixed_ms_; }
    double full_ms() const { return full_ms_; }

  private:
    void fit();
    double target_scale() const;

    double target_ms_, scale_;
    double fixed_ms_ = 0, full_ms_ = 0;
    // Sums over the images drawn of 1, x, y, x², xy, x = scale², y = milliseconds; older ones count less.
    double count_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
};

}  // namespace neuvv::editor
