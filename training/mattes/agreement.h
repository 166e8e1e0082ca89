// How the mattes of each camera agree with what those of the others say of them.
#pragma once

#include <string>
#include <vector>

#include "training/mattes/camera_shots.h"
#include "training/tree/pixel_mask.h"

namespace neuvv::training {

struct CameraAgreement {
    std::string camera;
    double lacking = 0;  // the share of what the other cameras show there that the mattes lack
    double beyond = 0;   // the share of the mattes that the other cameras do not show there
};

class AgreementSums {
  public:
    explicit AgreementSums(size_t cameras) : counts_(cameras) {}

    // Adds a matte of a camera, and the hull that the mattes of most cameras leave there. Both have the size of
    // working_image(); a hull may be off by a few pixels without a word.
    void add(uint32_t camera, const PixelMask& figure, const PixelMask& hull);
    // Worst first.
    std::vector<CameraAgreement> of(const std::vector<CameraShots>& cameras) const;

  private:
    // How many pixels the mattes of a camera have, and how many they lack or have too many.
    struct Counts {
        double hull = 0, figure = 0, lacking = 0, beyond = 0;
    };
    std::vector<Counts> counts_;  // by camera
};

}  // namespace neuvv::training
