// What a 2D detector saw in the images of calibrated cameras.
#pragma once

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "motion/joints.h"
#include "stage/camera.h"

namespace neuvv::motion {

struct KeyPoint {
    glm::dvec2 pixel{0};    // pixel centres are at +½, y down
    double confidence = 0;  // 0..1; 0: not seen
};
using KeyPoints = std::array<KeyPoint, kJoints>;  // of one person in one image

// A clip's key points from all sides.
struct Detections {
    std::vector<stage::Camera> cameras;
    size_t frames = 0;
    double fps = 25;
    std::vector<KeyPoints> points;        // frames × cameras: those of a frame are together
    std::array<bool, kJoints> lacking{};  // not known to the detector
    size_t images_with_others = 0;        // in which the detector saw more than one person

    KeyPoints& in(size_t frame, size_t camera) { return points[frame * cameras.size() + camera]; }
    const KeyPoints& in(size_t frame, size_t camera) const { return points[frame * cameras.size() + camera]; }
};

struct DetectedImage {
    KeyPoints points;
    const KeyPointLayout* layout = nullptr;  // null: no person in the image
    size_t people = 0;
};

// Reads a detector's JSON of one image, as OpenPose writes it and others do: {"people": [{"pose_keypoints_2d": [x, y,
// confidence, ...]}]}. Of several people, the one with the most confidence counts. Throws InputError with file and
// place.
DetectedImage read_key_points(const std::filesystem::path& file);

// An image whose key points are wanted.
struct WantedImage {
    std::string camera;  // the camera's name, by which key points may lie in folders: "c03"
    std::string image;   // the image's name without ending: "c03_f012"
    size_t camera_index = 0, frame = 0;
};

// Reads the key points of images from a folder: NAME.json or NAME_keypoints.json for the image NAME (what OpenPose
// writes), or, as Pose2Sim has it, a folder CAMERA or CAMERA_json for each camera, whose files are its frames in order
// of the numbers that their names end with. Images without a file count as images in which nobody was seen.
// `detections` has its cameras and frames; its points are filled. Throws InputError where no image has key points,
// where a folder has more frames than the camera, for key points of images that are not wanted, and for detectors that
// are mixed.
void read_detections(const std::filesystem::path& folder, std::span<const WantedImage> images, Detections& detections);

// The file of each image in a folder of them all: IMAGE_keypoints.json. Throws InputError where two images have one
// name.
std::vector<std::filesystem::path> key_point_files(const std::filesystem::path& folder,
                                                   std::span<const WantedImage> images);

// Writes the key points of one person, in the order of a KeyPointLayout, as read_key_points reads them; none: an image
// in which nobody was seen. The file is replaced atomically. Throws RuntimeFailure.
void write_person(const std::filesystem::path& file, std::span<const KeyPoint> points);
// The same from the joints, in BODY_25.
void write_key_points(const std::filesystem::path& file, const KeyPoints& points);

}  // namespace neuvv::motion
