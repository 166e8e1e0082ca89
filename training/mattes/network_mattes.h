// The mattes of a whole capture by a network.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "training/mattes/agreement.h"
#include "training/mattes/figure_mattes.h"
#include "training/mattes/matte_files.h"
#include "training/mattes/matte_network.h"

namespace neuvv::training {

// Adds the mattes of all images to the files: time by time, so that each camera's images are seen in order. A network
// that remembers begins anew with each camera, and where a camera's images pause. `backgrounds` are by camera; empty
// where the network wants no plate. `box` is figure_box(); where there is one, returns how the mattes of each camera
// agree with the others', worst first. Nothing where the caller stopped it. Throws InputError where images cannot be
// read, those of a camera have several sizes, or the network fails.
std::optional<std::vector<CameraAgreement>> add_network_mattes(
    MatteNetwork& network, const std::vector<CameraShots>& cameras, const std::vector<CameraBackground>& backgrounds,
    const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box, MatteFiles& files, const MatteProgress& progress);

}  // namespace neuvv::training
