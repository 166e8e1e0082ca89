// Finds the performer in images of cameras around it that have no mattes: by what differs from the background, where
// other cameras see something, too, and by colour.
//
// 1. What differs from a camera's background is fragments of the performer: cloth in the wall's colour and feet that
//    never move are lacking, and people in a doorway differ, too.
// 2. Convex hulls of these fragments carve a hull of space that most cameras agree on: what is outside of its image is
//    background.
// 3. Inside, the figure is what background cannot reach through gaps between the fragments; GrabCut moves its border to
//    where colours change.
// 4. In some rounds, a finer hull of the figures of most cameras gives each camera what it lacks, backgrounds are taken
//    from the frames in which no figure covers them, and GrabCut begins anew from both.
//
// Where a camera has a clean plate, its figure is what differs from the plate and is inside the hull, with those parts
// of the second hull that have the plate's colour.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "media/image.h"
#include "stage/camera.h"
#include "training/mattes/difference.h"

namespace neuvv::training {

// With fewer cameras, a hull says too little of the performer.
constexpr size_t kMinFigureCameras = 5;

struct FigureCamera {
    stage::Camera camera;     // a pinhole
    PixelMask unseen;         // pixels that say nothing
    media::Image background;  // a clean plate, or the median of images of which few show the performer
    bool is_clean = false;    // whether it is a plate
};

// An image of a camera at one time, of the camera's size, and the figure that is found in it.
struct Look {
    uint32_t camera = 0;
    media::Image image;
    PixelMask figure;
    // What the figures of most cameras say of this one, which is a little smaller than the performer.
    PixelMask hull;
    PixelMask possible;  // by the first hull; all else is background
    PixelMask sure;      // what is well inside the last hull
};

// Looks of one time.
using Moment = std::vector<Look>;

// By look, where the figures of most cameras show the performer, who is within the box: Look::hull. Needs
// kMinFigureCameras looks.
std::vector<PixelMask> hull_of_figures(const std::vector<FigureCamera>& cameras,
                                       const std::pair<glm::dvec3, glm::dvec3>& box, const Moment& moment);

// Receives how much of the work is done, from 0 to 1; returns false to stop.
using FigureProgress = std::function<bool(double share)>;

// Fills in the figures and hulls of all moments, whose performer is within the box (min, max in the world, metres). The
// further apart in time the moments are, the more of the backgrounds is seen in some of them. Lengths in pixels are
// those of images of 640 pixels, and scale with the images' size. Returns false where the caller stopped it.
bool find_figures(std::vector<FigureCamera> cameras, const std::pair<glm::dvec3, glm::dvec3>& box,
                  const MatteSettings& settings, std::vector<Moment>& moments, const FigureProgress& progress);

}  // namespace neuvv::training
