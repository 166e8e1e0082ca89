// Names of cameras by those of their images, for layouts that name images alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace neuvv::training {

// A name for each camera: what the names of its images have in common, up to a separator ("c00_f003" and "c00_f017":
// "c00"), or the name of its only image. Nothing where two cameras would get the same name, or one none.
std::optional<std::vector<std::string>> names_by_images(const std::vector<std::vector<std::string>>& images_of_cameras);

}  // namespace neuvv::training
