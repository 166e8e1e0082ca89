// The images of one camera of a data set, and its background.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// With fewer images of a camera without clean plate, their median says nothing about the background.
constexpr uint32_t kMinMedianFrames = 5;

struct CameraShots {
    const Rig* rig = nullptr;
    uint32_t camera = 0;
    std::vector<const Shot*> shots;

    const RigCamera& calibration() const { return rig->cameras[camera]; }
    const std::string& name() const { return calibration().name; }
    // Throws InputError where the calibration is for images of another size.
    media::Image read(ImageReader& reader, const ImageSource& source) const;
};

// All cameras that have images, by rig and in the order of each rig's cameras.
std::vector<CameraShots> cameras_with_shots(const std::vector<Rig>& rigs);

struct CameraBackground {
    media::Image image;     // of the images' size
    bool is_clean = false;  // whether it is the clean plate, else it is the median of images
    Note wrong_plate;       // why the clean plate is not used; empty where it is, or where there is none
};

// The camera's clean plate, where it shows what most of its images show, else the median of up to kMaxMedianFrames
// images. Throws InputError where there is no plate and fewer than kMinMedianFrames images, or images of several sizes.
CameraBackground background_of(const CameraShots& camera);

}  // namespace neuvv::training
