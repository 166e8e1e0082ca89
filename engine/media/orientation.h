// How the pixels of a file are turned before they are shown, as Exif and the display matrices of videos say it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "media/image.h"

namespace neuvv::media {

// Exif's numbers. Those from 5 on exchange width and height.
enum class Orientation : uint8_t {
    kUpright = 1,
    kMirrored = 2,  // left and right are exchanged
    kTurned180 = 3,
    kFlipped = 4,     // top and bottom are exchanged
    kTransposed = 5,  // mirrored at the diagonal from the top left
    kTurned90 = 6,    // turned clockwise to be shown
    kTransverse = 7,  // mirrored at the other diagonal
    kTurned270 = 8,
};

inline bool exchanges_sides(Orientation orientation) {
    return orientation >= Orientation::kTransposed;
}
// The size of an image of this stored size when it is shown.
inline ImageSize shown_size(ImageSize stored, Orientation orientation) {
    return exchanges_sides(orientation) ? ImageSize{stored.height, stored.width} : stored;
}
// The image as it is shown.
Image shown(Image stored, Orientation orientation);

// By the tag of a TIFF structure, which is what Exif data are; upright where there is none, or where it is damaged.
Orientation exif_orientation(const uint8_t* tiff, size_t bytes);
// The size of a PNG or JPEG in pixels, and how it is to be shown, by its header alone: the rest may be damaged. Throws
// InputError.
struct ImageHeader {
    ImageSize stored;
    Orientation orientation = Orientation::kUpright;
};
ImageHeader image_header(const std::filesystem::path& path);
ImageHeader image_header(const uint8_t* bytes, size_t size, const std::string& name);
// By the nine numbers of an MP4's or QuickTime's matrix; nothing where it turns by other than quarters.
std::optional<Orientation> matrix_orientation(const int32_t matrix[9]);

// "turned by 90° clockwise", for messages.
std::string orientation_text(Orientation orientation);

}  // namespace neuvv::media
