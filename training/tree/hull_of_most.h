// The hull that the mattes of most cameras leave: a few may be wrong about any place.
#pragma once

#include <vector>

#include "training/tree/pixel_mask.h"
#include "training/tree/silhouettes.h"

namespace neuvv::training {

// Where a camera says that the performer is, at one time.
struct CameraMask {
    const stage::Camera* camera = nullptr;  // of the mask's size
    PixelMask mask;
    const PixelMask* unseen = nullptr;  // pixels that say nothing; null: none
};

// The box is divided into so many cells along each axis first.
constexpr uint32_t kFirstHullGrid = 24;

struct HullSettings {
    // A cell is kept where at least three cameras show the performer in it, and at most this share of those that see it
    // show background alone, or one of eight and more.
    double dissent = 0.05;
    // How often the cells are divided into halves along each axis.
    uint32_t divisions = 4;
    // Whether the smallest cells are judged by their centres. Else a cell counts where any part of it does, which grows
    // the hull by about a cell, and by more where cameras are near.
    bool by_centres = false;
};

// How often the cells are to be divided so that, in the middle of the box, they have about this size in the images.
uint32_t divisions_for(const std::vector<stage::Camera>& cameras, const std::pair<glm::dvec3, glm::dvec3>& box,
                       double pixels);

// The smallest cells that are kept.
std::vector<HullCell> cells_of_most(const std::vector<Silhouette>& silhouettes,
                                    const std::pair<glm::dvec3, glm::dvec3>& box, const HullSettings& settings);

// By camera, where the hull is seen.
std::vector<PixelMask> hull_of_most(const std::vector<CameraMask>& cameras,
                                    const std::pair<glm::dvec3, glm::dvec3>& box, const HullSettings& settings);

}  // namespace neuvv::training
