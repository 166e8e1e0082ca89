// A 2D detector of key points: a network in an ONNX file that the user names, run by OpenCV on the processor.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "media/image.h"
#include "motion/video/key_points.h"

namespace neuvv::motion {

// What a network wants to see of a colour of 0 to 255.
enum class PixelScale {
    kImageNet,  // (colour − mean) / deviation of ImageNet's images, channel by channel
    kUnit,      // 0 to 1
    kBytes,     // 0 to 255
};

// Finds the key points of the one person that an image shows. Networks are top-down ones: their input is an RGB image
// of a person, 1×3×height×width; their output is either
//   - heat maps, 1×K×h×w, one a key point (SimpleBaseline, HRNet, ViTPose), or
//   - one line of the image's columns and one of its rows, 1×K×w and 1×K×h (SimCC: RTMPose).
// Value i of n stands for the place (i + ½) / n of the input. K says which key points they are (find_key_point_layout).
class KeyPointDetector {
  public:
    // Opens the network and runs it once. Throws InputError for files that are missing, no ONNX model, have other
    // inputs or outputs, or operations that OpenCV lacks.
    KeyPointDetector(const std::filesystem::path& onnx, PixelScale scale);
    ~KeyPointDetector();
    KeyPointDetector(const KeyPointDetector&) = delete;
    KeyPointDetector& operator=(const KeyPointDetector&) = delete;

    const KeyPointLayout& layout() const;

    // The key points in the layout's order, in pixels of the image; none where it shows the background alone (see
    // person_box). A confidence is the peak's value, within 0 to 1; of SimCC the lesser of both. Throws InputError
    // where the network cannot be run.
    std::vector<KeyPoint> detect(const media::Image& image);

  private:
    struct Detector;
    std::unique_ptr<Detector> detector_;
};

}  // namespace neuvv::motion
