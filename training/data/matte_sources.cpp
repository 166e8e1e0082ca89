#include "training/data/matte_sources.h"

#include <algorithm>

#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

std::filesystem::path mattes_folder(const Rig& rig) {
    return rig.folder / "mattes";
}

std::filesystem::path matte_file(const std::filesystem::path& folder, const Rig& rig, const Shot& shot) {
    std::error_code ignored;
    const std::filesystem::path file = folder / (shot.name + ".png");
    if (std::filesystem::is_regular_file(file, ignored)) return file;
    std::string camera = rig.cameras[shot.camera].name;
    std::ranges::replace(camera, '/', '_');
    const std::filesystem::path former = folder / (camera + "_" + shot.image.path.stem().string() + ".png");
    return shot.image.video_frame < 0 && std::filesystem::is_regular_file(former, ignored) ? former : file;
}

std::vector<std::string> matte_sources(const std::vector<Rig>& splits) {
    constexpr size_t kMostImages = 8;  // of a split, whose alpha is looked at
    bool mattes = false, masks = false, alpha = false;
    std::filesystem::path masks_folder;
    std::error_code ignored;
    for (const Rig& rig : splits) {
        const bool means_matte = rig.masks == MaskMeaning::kMatte || rig.masks == MaskMeaning::kLabels;
        std::vector<const Shot*> first(rig.cameras.size());
        for (const Shot& shot : rig.shots) {
            mattes |= std::filesystem::is_regular_file(matte_file(mattes_folder(rig), rig, shot), ignored);
            if (means_matte && !shot.mask.path.empty()) {
                masks = true;
                masks_folder = shot.mask.path.lexically_relative(rig.folder);
            }
            if (!first[shot.camera]) first[shot.camera] = &shot;
        }
        for (size_t i = 0; i < std::min(first.size(), kMostImages) && !alpha; ++i) {
            const Shot* shot = first[i * first.size() / std::min(first.size(), kMostImages)];
            if (!shot) continue;
            const media::Image image = ImageReader().read(shot->image);
            for (size_t at = 3; at < image.rgba.size() && !alpha; at += 4) alpha = image.rgba[at] != 255;
        }
    }
    std::vector<std::string> sources;
    if (mattes) sources.emplace_back("mattes/");
    if (masks) sources.push_back(masks_folder.begin()->string() + "/");
    if (alpha) sources.emplace_back("the alpha of the images");
    return sources;
}

}  // namespace neuvv::training
