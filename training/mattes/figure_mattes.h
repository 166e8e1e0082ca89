// The mattes of a whole capture, whose cameras are looked at together.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "training/mattes/agreement.h"
#include "training/mattes/camera_shots.h"
#include "training/mattes/figure_search.h"
#include "training/mattes/matte_files.h"

namespace neuvv::training {

// Receives how many images are done, and of how many; returns false to stop.
using MatteProgress = std::function<bool(uint64_t done, uint64_t total)>;

// The box (min, max in the world, metres) in which the performer of these rigs is sought, whose cameras it is for.
// Nothing where cameras cannot be looked at together, as there are too few, few at most times, or they all look in
// one direction: `why`.
std::optional<std::pair<glm::dvec3, glm::dvec3>> figure_box(const std::vector<Rig>& rigs,
                                                            const std::vector<CameraShots>& cameras, Note& why);

// Adds the mattes of all images to the files. `backgrounds` are by camera. Returns, worst first, how the mattes of each
// camera agree with the others; nothing where the caller stopped it. Throws InputError where images cannot be read or
// those of a camera have several sizes.
std::optional<std::vector<CameraAgreement>> add_figure_mattes(const std::vector<CameraShots>& cameras,
                                                              std::vector<CameraBackground> backgrounds,
                                                              const std::pair<glm::dvec3, glm::dvec3>& box,
                                                              const MatteSettings& settings, MatteFiles& files,
                                                              const MatteProgress& progress);

}  // namespace neuvv::training
