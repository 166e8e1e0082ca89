// What readers of calibrations share: poses and lenses in OpenCV's convention, and checks of lenses, poses and names.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/formats/json.h"
#include "media/image.h"
#include "training/data/layouts/rig/candidates.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

constexpr double kMaxSkew = 1e-3;  // of the focal length; lens.h has no skew
constexpr uint32_t kHoldOut = 8;   // where files name no test cameras, every 8th is held out, beginning with the first

// The camera's pose, with OpenGL axes, where x_camera = rotation · x_world + translation in OpenCV axes (x right,
// y down, z forward).
glm::dmat4 world_from_opencv(const glm::dmat3& rotation, const glm::dvec3& translation);

// The rotation of a vector (Rodrigues: its axis times its angle in radians) or of a matrix of 3×3 numbers, row by row.
// Throws InputError(file, place, …) for numbers that are no rotation.
glm::dmat3 opencv_rotation(const std::vector<double>& numbers, const std::string& file, const std::string& place);

// The lens of a camera matrix (3×3, row by row) and of distortion coefficients as OpenCV orders them: k1 k2 p1 p2 k3 k4
// k5 k6, of which the last may be missing, or k1 … k4 of a fisheye. OpenCV has the centre of the first pixel at 0, and
// NeuVV at ½. Further terms must be 0. Throws InputError(file, place, …) for what no lens of lens.h has.
interchange::Lens opencv_lens(const std::vector<double>& matrix, const std::vector<double>& distortion, bool fisheye,
                              const std::string& file, const std::string& place);

// The numbers of an array, or of an array of arrays row by row, of which there are `count`. Throws InputError.
std::vector<double> json_numbers(const JsonNode& node, size_t count);

// Scales the camera's lens to the size of its images where the calibration is for the same images at another size.
// `image` is the first of them. A video whose pixels are not square may have the calibration's shape when it is shown.
// Where their shape is another, as that of cropped images is, the lens stays as it is and rig.misfit says so. A lens
// that knows no size stays as it is, too.
void fit_to_images(RigCamera& camera, ImageSource image, Rig& rig, const std::string& place);

// Throws InputError(file, place, …) for a lens or a camera position that cannot be right: numbers that are not finite
// or absurdly large, a focal length that is not positive, a width of 0 beside a height or the reverse.
void expect_sound(const RigCamera& camera, const std::string& file, const std::string& place);

// Throws InputError for a name that leads out of the data set's folder, is empty, or cannot be a file name.
void expect_inside(const std::string& name, const std::string& file, const std::string& place);

// The files of a folder, in order of their names, that have this ending, in small letters or capitals, and whose first
// kilobytes hold all of these texts: some programs leave the name of a calibration to their users.
std::vector<std::filesystem::path> find_files_by_header(const std::filesystem::path& folder, const std::string& ending,
                                                        const std::vector<std::string>& texts);

// The newest of the calibrations that find_files_by_header finds in a capture's calibration_folders; an empty path
// where there are none.
Choice newest_calibration(const std::filesystem::path& folder, const std::string& ending,
                          const std::vector<std::string>& texts);
// The same of the nearest of its session_folders that has any.
Choice session_calibration(const std::filesystem::path& folder, const std::string& ending,
                           const std::vector<std::string>& texts);
// The former, or where there is none the latter.
Choice calibration_of(const std::filesystem::path& folder, const std::string& ending,
                      const std::vector<std::string>& texts);

}  // namespace neuvv::training
