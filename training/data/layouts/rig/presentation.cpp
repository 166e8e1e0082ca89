#include "training/data/layouts/rig/presentation.h"

#include <fmt/format.h>

#include <algorithm>

#include "media/orientation.h"
#include "media/video.h"

namespace neuvv::training {

namespace {

constexpr size_t kMaxNames = 12;  // in a remark

bool same_shape(media::ImageSize a, const interchange::Lens& b) {
    // A scaled copy has sides of whole pixels.
    const double rounding = 1.0 / std::min(a.width, b.width) + 1.0 / std::min(a.height, b.height);
    return std::abs(double(a.width) * b.height / (double(a.height) * b.width) - 1) <= rounding;
}

bool is_video_frame(const ImageSource& image) {
    return image.video_frame >= 0;
}

std::string exif_note(const media::ImageHeader& header, bool as_stored, const Rig& rig) {
    const std::string turn = media::orientation_text(header.orientation);
    if (!as_stored) return fmt::format("images shown {}, as their Exif says", turn);
    return fmt::format("images not {}, as their Exif says, but used as stored, as {} was calibrated from", turn,
                       rig.file);
}

}  // namespace

bool used_as_stored(const ImageSource& image, const interchange::Lens& lens, bool by_default) {
    if (is_video_frame(image)) return false;
    const media::ImageHeader header = media::image_header(image.path);
    if (!media::exchanges_sides(header.orientation) || lens.width == 0 || lens.height == 0) return by_default;
    const bool stored = same_shape(header.stored, lens);
    return stored == same_shape(media::shown_size(header.stored, header.orientation), lens) ? by_default : stored;
}

void settle_presentation(Rig& rig) {
    std::vector<const Shot*> first(rig.cameras.size());
    for (const Shot& shot : rig.shots)
        if (!first[shot.camera]) first[shot.camera] = &shot;
    std::vector<bool> as_stored(rig.cameras.size());
    TextsByCamera texts;
    for (size_t c = 0; c < rig.cameras.size(); ++c) {
        if (!first[c]) continue;
        const ImageSource& image = first[c]->image;
        if (is_video_frame(image)) {
            for (const std::string& note : media::VideoReader(image.path).notes())
                texts.emplace_back(rig.cameras[c].name, "video " + note);
            continue;
        }
        as_stored[c] = used_as_stored(image, rig.cameras[c].lens, rig.images_as_stored);
        const media::ImageHeader header = media::image_header(image.path);
        if (header.orientation != media::Orientation::kUpright)
            texts.emplace_back(rig.cameras[c].name, exif_note(header, as_stored[c], rig));
        rig.cameras[c].plate.as_stored = as_stored[c];
    }
    for (Shot& shot : rig.shots) shot.image.as_stored = shot.mask.as_stored = as_stored[shot.camera];
    add_remarks(rig, texts);
}

void add_remarks(Rig& rig, const TextsByCamera& texts) {
    std::vector<std::pair<std::string, std::vector<std::string>>> names_by_text;  // in order of first use
    for (const auto& [name, text] : texts) {
        auto at = std::ranges::find(names_by_text, text, [](const auto& entry) { return entry.first; });
        if (at == names_by_text.end()) at = names_by_text.insert(at, {text, {}});
        at->second.push_back(name);
    }
    for (auto& [text, names] : names_by_text) {
        const size_t more = names.size() - std::min(names.size(), kMaxNames);
        names.resize(names.size() - more);
        rig.remarks.push_back(fmt::format("{} {}{}: {}", names.size() + more > 1 ? "cameras" : "camera",
                                          fmt::join(names, ", "), more ? fmt::format(" and {} more", more) : "", text));
    }
}

}  // namespace neuvv::training
