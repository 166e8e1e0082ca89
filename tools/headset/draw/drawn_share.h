// Chooses how much of an eye's image is drawn where there is no time for a ray in each pixel: the compositor stretches
// a smaller rectangle over the same field of view.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace neuvv::headset {

class DrawnShare {
  public:
    // The shares of an image's width and height that are drawn. A smaller rectangle than the last would show the edges
    // of set and hands as steps; there, rays become fewer than pixels.
    static constexpr double kShares[] = {1, 0.875, 0.75, 0.625, 0.5};
    // The share grows once there has been time for more in so many images, one after the other. It shrinks at once. So
    // a load that changes all the time does not make it flicker.
    static constexpr uint32_t kPatience = 30;

    // The share of the next image, where `scale` rays for each pixel along a side of the whole image take the time that
    // there is.
    double update(double scale) {
        if (scale < share_) {
            share_ = largest(scale);
            images_ = 0;
            return share_;
        }
        least_ = images_ == 0 ? scale : std::min(least_, scale);
        images_ = largest(scale) > share_ ? images_ + 1 : 0;
        if (images_ < kPatience) return share_;
        share_ = largest(least_);
        images_ = 0;
        return share_;
    }
    double share() const { return share_; }

  private:
    static double largest(double scale) {
        const auto* found =
            std::find_if(std::begin(kShares), std::end(kShares), [&](double share) { return share <= scale; });
        return found == std::end(kShares) ? *std::rbegin(kShares) : *found;
    }
    double share_ = *std::rbegin(kShares);
    double least_ = 0;     // the smallest scale of images_
    uint32_t images_ = 0;  // images, one after the other, in which there was time for a larger share
};

}  // namespace neuvv::headset
