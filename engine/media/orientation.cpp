#include "media/orientation.h"

#include <cmath>
#include <cstring>

namespace neuvv::media {

namespace {

constexpr uint32_t kOrientationTag = 0x112, kShort = 3;
constexpr size_t kEntryBytes = 12;

// Numbers of a TIFF structure, whose first bytes say which of a number's bytes comes first.
class Tiff {
  public:
    Tiff(const uint8_t* bytes, size_t size) : bytes_(bytes), size_(size), big_(size > 0 && bytes[0] == 'M') {}

    // Little- or big-endian; 0 beyond the end.
    uint32_t number(size_t at, size_t count) const {
        if (at > size_ || count > size_ - at) return 0;
        uint32_t value = 0;
        for (size_t i = 0; i < count; ++i) value = value << 8 | bytes_[at + (big_ ? i : count - 1 - i)];
        return value;
    }

  private:
    const uint8_t* bytes_;
    size_t size_;
    bool big_;
};

}  // namespace

Image shown(Image stored, Orientation orientation) {
    if (orientation == Orientation::kUpright) return stored;
    const ImageSize size = shown_size({stored.width, stored.height}, orientation);
    Image image(size.width, size.height);
    const uint32_t right = stored.width - 1, bottom = stored.height - 1;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            uint32_t u = exchanges_sides(orientation) ? y : x, v = exchanges_sides(orientation) ? x : y;
            switch (orientation) {
                case Orientation::kMirrored:
                case Orientation::kTurned270:
                    u = right - u;
                    break;
                case Orientation::kFlipped:
                case Orientation::kTurned90:
                    v = bottom - v;
                    break;
                case Orientation::kTurned180:
                case Orientation::kTransverse:
                    u = right - u, v = bottom - v;
                    break;
                default:
                    break;
            }
            std::memcpy(image.at(x, y), stored.at(u, v), 4);
        }
    return image;
}

Orientation exif_orientation(const uint8_t* tiff, size_t bytes) {
    const Tiff file(tiff, bytes);
    if (file.number(2, 2) != 42) return Orientation::kUpright;
    const size_t directory = file.number(4, 4);
    const uint32_t entries = file.number(directory, 2);
    for (uint32_t i = 0; i < entries; ++i) {
        const size_t entry = directory + 2 + kEntryBytes * i;
        if (entry + kEntryBytes > bytes) break;
        if (file.number(entry, 2) != kOrientationTag || file.number(entry + 2, 2) != kShort) continue;
        const uint32_t value = file.number(entry + 8, 2);
        return value >= 1 && value <= 8 ? static_cast<Orientation>(value) : Orientation::kUpright;
    }
    return Orientation::kUpright;
}

std::optional<Orientation> matrix_orientation(const int32_t matrix[9]) {
    // A stored pixel (u, v) is shown at (a u + c v, b u + d v), moved into the image.
    const double a = matrix[0], b = matrix[1], c = matrix[3], d = matrix[4];
    const double along = std::min(std::abs(a), std::abs(d)), across = std::min(std::abs(b), std::abs(c));
    constexpr double kSlight = 0.02;  // of a side: a turn by a degree
    if (std::max(std::abs(b), std::abs(c)) <= kSlight * along && along > 0)
        return a > 0 ? (d > 0 ? Orientation::kUpright : Orientation::kFlipped)
                     : (d > 0 ? Orientation::kMirrored : Orientation::kTurned180);
    if (std::max(std::abs(a), std::abs(d)) <= kSlight * across && across > 0)
        return b > 0 ? (c > 0 ? Orientation::kTransposed : Orientation::kTurned90)
                     : (c > 0 ? Orientation::kTurned270 : Orientation::kTransverse);
    return {};
}

std::string orientation_text(Orientation orientation) {
    switch (orientation) {
        case Orientation::kUpright:
            return "as stored";
        case Orientation::kMirrored:
            return "mirrored";
        case Orientation::kTurned180:
            return "turned by 180°";
        case Orientation::kFlipped:
            return "flipped upside down";
        case Orientation::kTransposed:
            return "mirrored and turned by 270° clockwise";
        case Orientation::kTurned90:
            return "turned by 90° clockwise";
        case Orientation::kTransverse:
            return "mirrored and turned by 90° clockwise";
        case Orientation::kTurned270:
            return "turned by 270° clockwise";
    }
    return "";
}

}  // namespace neuvv::media
