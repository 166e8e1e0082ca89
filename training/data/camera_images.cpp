#include "training/data/camera_images.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "training/data/mask_image.h"
#include "training/data/matte_sources.h"
#include "training/data/plate.h"

namespace neuvv::training {

namespace {

constexpr double kMinSeenShare = 0.5;  // of a pinhole image; a lens that shows less of it must be calibrated wrongly

void expect_size(media::ImageSize found, const ImageSource& source, media::ImageSize size, const std::string& whose) {
    if (found.width == size.width && found.height == size.height) return;
    throw InputError(source.path.string(), "",
                     fmt::format("is {}×{}, but {} {}×{}", found.width, found.height, whose, size.width, size.height),
                     "give all images and masks of a camera the size that its calibration is for");
}

void set_alpha(media::Image& image, const media::Image& matte, MaskMeaning meaning = MaskMeaning::kMatte) {
    const MaskValues values(matte);
    const bool labels = meaning == MaskMeaning::kLabels;
    for (size_t i = 0; i < image.rgba.size() / 4; ++i)
        image.rgba[4 * i + 3] = labels && values[i] != 0 ? uint8_t{255} : values[i];
}

// The pixels that a mask excludes. Any value other than 0 counts as white, as in the programs that write these masks.
std::vector<bool> ignored_by(const media::Image& mask, MaskMeaning meaning) {
    const MaskValues values(mask);
    std::vector<bool> ignored(mask.rgba.size() / 4);
    for (size_t i = 0; i < ignored.size(); ++i) ignored[i] = (values[i] != 0) == (meaning == MaskMeaning::kIgnore);
    return ignored;
}

// Gives the pixels of alpha 0 the colours of the other image.
void fill_background(media::Image& image, const media::Image& captured) {
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        if (image.rgba[i + 3] == 0) std::copy_n(&captured.rgba[i], 3, &image.rgba[i]);
}

}  // namespace

CameraImages::CameraImages(const Rig& rig, uint32_t camera, const stage::Camera& pinhole)
    : rig_(rig),
      from_(rig.cameras[camera]),
      size_{pinhole.width, pinhole.height},
      whose_(fmt::format("its camera {} in {} says", from_.name, rig.file)) {
    // The map takes memory according to the calibration's size, so that size is checked before.
    if (from_.lens.distorts()) {
        const auto first = std::ranges::find(rig.shots, camera, &Shot::camera);
        if (first != rig.shots.end()) expect_size(size_of(first->image), first->image, size_, whose_);
        map_ = undistortion();
    }
    if (from_.plate.path.empty()) return;
    plate_ = read_plate(from_.plate, [&](media::ImageSize found) { expect_size(found, from_.plate, size_, whose_); });
    if (map_) plate_ = undistort(plate_, *map_, ColourOf::kCapture);
}

Undistortion CameraImages::undistortion() const {
    interchange::Lens lens = from_.lens;
    lens.width = size_.width;
    lens.height = size_.height;
    Undistortion map = make_undistortion(lens);
    if (map.seen_share >= kMinSeenShare) return map;
    const std::string fold =
        map.fold_degrees > 0 ? fmt::format(" (it folds over {:.1f}° off the axis)", map.fold_degrees) : "";
    throw InputError(rig_.file, "camera " + from_.name,
                     fmt::format("its lens distortion{} leaves only {:.0f} % of the image", fold, 100 * map.seen_share),
                     "check the coefficients, and that focal length and size are of the same image");
}

media::Image CameraImages::read(ImageReader& reader, const ImageSource& source) const {
    return reader.read(source, [&](media::ImageSize found) { expect_size(found, source, size_, whose_); });
}

CameraImage CameraImages::read(const Shot& shot, Background background) {
    media::Image image = read(images_, shot.image);
    std::vector<bool> ignored;
    if (!shot.mask.path.empty()) {
        const media::Image mask = read(masks_, shot.mask);
        if (rig_.masks == MaskMeaning::kMatte || rig_.masks == MaskMeaning::kLabels)
            set_alpha(image, mask, rig_.masks);
        else
            ignored = ignored_by(mask, rig_.masks);
    }
    apply_matte_file(shot, image);
    if (map_) {
        const media::Image distorted = std::move(image);
        const bool captured = plate_.width > 0;
        image = undistort(distorted, *map_, captured ? ColourOf::kCapture : ColourOf::kForeground);
        if (!captured && background == Background::kCaptured)
            fill_background(image, undistort(distorted, *map_, ColourOf::kCapture));
        ignored = undistort_ignored(ignored, *map_);
    }
    for (size_t i = 0; i < ignored.size(); ++i)
        if (ignored[i]) image.rgba[4 * i + 3] = 0;
    return {std::move(image), std::move(ignored)};
}

// Uses the image's file in the folder of mattes. Where that folder exists and has no such file, an opaque image is an
// error, as all of it would count as performer.
void CameraImages::apply_matte_file(const Shot& shot, media::Image& image) {
    std::error_code ignored;
    const std::filesystem::path folder = mattes_folder(rig_), file = matte_file(folder, rig_, shot);
    if (std::filesystem::is_regular_file(file, ignored))
        set_alpha(image, read(mattes_, {file, -1}));
    else if (std::filesystem::is_directory(folder, ignored) && is_opaque(image))
        throw InputError(file.string(), "", fmt::format("is missing: {} has no other matte", shot.name),
                         {Remedy::kMakeMattes, rig_.folder.string()});
}

}  // namespace neuvv::training
