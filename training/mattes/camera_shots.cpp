#include "training/mattes/camera_shots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "training/data/plate.h"

namespace neuvv::training {

namespace {

// A plate may be darker or brighter than the images, but not by so many steps of 255 in the middle of their
// differences.
constexpr int kMostPlateOffset = 60;
// Nor may more than half of it differ by more steps, or by a larger share of the images' own contrast.
constexpr int kMostPlateDeviation = 6;
constexpr double kMostOfPlateContrast = 0.5;

template <typename Value>
int middle_of(size_t count, const Value& value) {
    std::vector<int> values(count);
    for (size_t i = 0; i < count; ++i) values[i] = value(i);
    const auto middle = values.begin() + static_cast<ptrdiff_t>(count / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

// Whether most of what the plate shows is what the camera's images show.
bool is_plate_of(const media::Image& plate, const media::Image& median) {
    const size_t pixels = median.rgba.size() / 4;
    for (size_t c = 0; c < 3; ++c) {
        const auto seen = [&](size_t i) { return int{median.rgba[4 * i + c]}; };
        const auto difference = [&](size_t i) { return int{plate.rgba[4 * i + c]} - seen(i); };
        const int offset = middle_of(pixels, difference), level = middle_of(pixels, seen);
        const int deviation = middle_of(pixels, [&](size_t i) { return std::abs(difference(i) - offset); });
        const int contrast = middle_of(pixels, [&](size_t i) { return std::abs(seen(i) - level); });
        if (std::abs(offset) > kMostPlateOffset ||
            (deviation > kMostPlateDeviation && deviation > kMostOfPlateContrast * contrast))
            return false;
    }
    return true;
}

media::Image median_of_images(const CameraShots& camera) {
    const std::vector<const Shot*>& shots = camera.shots;
    const size_t count = std::min<size_t>(shots.size(), kMaxMedianFrames);
    ImageReader reader;
    std::vector<media::Image> frames;
    for (size_t i = 0; i < count; ++i) {
        frames.push_back(camera.read(reader, shots[i * (shots.size() - 1) / (count - 1)]->image));
        if (frames[i].rgba.size() != frames[0].rgba.size() || frames[i].width != frames[0].width)
            throw InputError(camera.rig->file, shots[0]->place, "the images of its camera have several sizes",
                             "give all images of a camera one size");
    }
    return median_background(frames);
}

// Where the calibration says how large images are, others are not decoded. Camera and source must outlive it.
ImageReader::ExpectSize size_of_camera(const CameraShots& camera, const ImageSource& source) {
    const interchange::Lens& lens = camera.calibration().lens;
    if (lens.width == 0) return {};
    return [&](media::ImageSize size) {
        if (size.width != lens.width || size.height != lens.height)
            throw InputError(source.path.string(), "",
                             fmt::format("is {}×{}, but its camera {} in {} says {}×{}", size.width, size.height,
                                         camera.name(), camera.rig->file, lens.width, lens.height),
                             "give all images and mattes of a camera the size that its calibration is for");
    };
}

}  // namespace

media::Image CameraShots::read(ImageReader& reader, const ImageSource& source) const {
    return reader.read(source, size_of_camera(*this, source));
}

std::vector<CameraShots> cameras_with_shots(const std::vector<Rig>& rigs) {
    std::vector<CameraShots> cameras;
    for (const Rig& rig : rigs) {
        std::vector<CameraShots> of_rig(rig.cameras.size());
        for (uint32_t i = 0; i < of_rig.size(); ++i) of_rig[i] = {&rig, i, {}};
        for (const Shot& shot : rig.shots) of_rig[shot.camera].shots.push_back(&shot);
        for (CameraShots& camera : of_rig)
            if (!camera.shots.empty()) cameras.push_back(std::move(camera));
    }
    return cameras;
}

CameraBackground background_of(const CameraShots& camera) {
    const ImageSource& source = camera.calibration().plate;
    const bool has_plate = !source.path.empty(), has_images = camera.shots.size() >= kMinMedianFrames;
    if (!has_plate && !has_images)
        throw InputError(camera.rig->file, "camera " + camera.name(),
                         fmt::format("has no clean plate and {} images: their median says nothing about the background",
                                     camera.shots.size()),
                         fmt::format("give it a clean plate, or at least {} images", kMinMedianFrames));
    if (!has_plate) return {.image = median_of_images(camera)};
    CameraBackground background{.image = read_plate(source, size_of_camera(camera, source)), .is_clean = true};
    if (!has_images) return background;
    media::Image median = median_of_images(camera);
    const bool same_size = background.image.width == median.width && background.image.height == median.height;
    if (!same_size || is_plate_of(background.image, median)) return background;
    return {.image = std::move(median),
            .wrong_plate = Note(fmt::format("{} does not show what the images of camera {} show; it is not used",
                                            source.path.string(), camera.name()))};
}

}  // namespace neuvv::training
