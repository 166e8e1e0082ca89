// What a 2D detector saw in the images of calibrated cameras.
#pragma once

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "motion/skeleton/joints.h"
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
    std::vector<KeyPoints> points;        // of one person; frames × cameras: those of a frame are together
    std::array<bool, kJoints> lacking{};  // not known to the detector
    // Everybody in each image, in the order of `points`, the most confident person first (people.h).
    std::vector<std::vector<KeyPoints>> people;
    std::vector<std::string> notes;  // what was decided, a line each

    KeyPoints& in(size_t frame, size_t camera) { return points[frame * cameras.size() + camera]; }
    const KeyPoints& in(size_t frame, size_t camera) const { return points[frame * cameras.size() + camera]; }
};

// What a detector saw in an image.
struct ImagePeople {
    std::string image;                          // its name without ending, or the number of its frame
    std::vector<std::vector<KeyPoint>> people;  // the most confident one first; all have equally many points
};

struct KeyPointFile {
    std::vector<ImagePeople> images;
    bool of_many = false;  // the file names the images itself
};

// Reads a detector's JSON of one image: {"people": [{"pose_keypoints_2d": [x, y, confidence, ...]}]} of OpenPose, or
// [{"keypoints": [[x, y], ...], "keypoint_scores": [...]}] of MMPose; or of many: {"instance_info": [{"frame_id": 0,
// "instances": [...]}]} or that list alone of MMPose, [{"image_id": "a.png", "keypoints": [x, y, confidence, ...]}] of
// AlphaPose. Throws InputError with file and place.
KeyPointFile read_key_points(const std::filesystem::path& file);

constexpr const char* kKeyPointEnding = "_keypoints";  // of a file's name, behind that of its image
// "c03_f012_keypoints.json" and "c03_f012.png.json" → "c03_f012".
std::string image_of_key_points(const std::filesystem::path& file);

// The layout of the key points of one detector: by their number, and where two sets have as many by where they lie.
// Null where that is not clear, or nobody was seen.
const KeyPointLayout* layout_of(std::span<const ImagePeople> images);
KeyPoints joints_of(const std::vector<KeyPoint>& points, const KeyPointLayout& layout);

// An image whose key points are wanted.
struct WantedImage {
    std::string camera;  // the camera's name, by which key points may lie in folders: "c03"
    std::string image;   // the image's name without ending, unique in its camera: "c03_f012"; it may end with a number
    size_t camera_index = 0, frame = 0;
};

// Reads the key points of images from a folder. Either its files are of all cameras: NAME.json or NAME_keypoints.json
// for the image NAME, or one file that names the images; or there is, as Pose2Sim has it, a folder CAMERA or
// CAMERA_json for each camera, or a file CAMERA.json that numbers its frames. Names match where what stands before the
// number at their end is the same and the numbers are equal, whatever the zeros before them; in a camera's folder the
// numbers alone count. Where numbers begin elsewhere than those of the images do, they are moved by that, and where
// they do not fit but every frame has a file, files go by their order; notes say so. Images without a file count as
// images in which nobody was seen. `detections` has its cameras and frames; its points are filled. Throws InputError
// where no image has key points, for key points of images that are not wanted, for detectors that are mixed, and where
// it is not clear of which layout they are. `points` has the most confident person of each image.
void read_detections(const std::filesystem::path& folder, std::span<const WantedImage> images, Detections& detections,
                     const KeyPointLayout* layout = nullptr);  // null: layout_of

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
