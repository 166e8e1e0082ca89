#include "tools/image_drawing.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

namespace neuvv::tools {

namespace {

// The glyph of a character has 3×5 dots, row by row from the top.
constexpr std::string_view kCharacters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ-_./(),: ?";
constexpr std::array<uint16_t, kCharacters.size()> kDots = {
    0b111'101'101'101'111, 0b010'110'010'010'111, 0b111'001'111'100'111, 0b111'001'111'001'111, 0b101'101'111'001'001,
    0b111'100'111'001'111, 0b111'100'111'101'111, 0b111'001'001'001'001, 0b111'101'111'101'111, 0b111'101'111'001'111,
    0b010'101'111'101'101, 0b110'101'110'101'110, 0b011'100'100'100'011, 0b110'101'101'101'110, 0b111'100'110'100'111,
    0b111'100'110'100'100, 0b011'100'101'101'011, 0b101'101'111'101'101, 0b111'010'010'010'111, 0b001'001'001'101'010,
    0b101'101'110'101'101, 0b100'100'100'100'111, 0b101'111'111'101'101, 0b110'101'101'101'101, 0b010'101'101'101'010,
    0b110'101'110'100'100, 0b010'101'101'110'011, 0b110'101'110'101'101, 0b011'100'010'001'110, 0b111'010'010'010'010,
    0b101'101'101'101'111, 0b101'101'101'101'010, 0b101'101'111'111'101, 0b101'101'010'101'101, 0b101'101'010'010'010,
    0b111'001'010'100'111, 0b000'000'111'000'000, 0b000'000'000'000'111, 0b000'000'000'000'010, 0b001'001'010'100'100,
    0b001'010'010'010'001, 0b100'010'010'010'100, 0b000'000'000'010'100, 0b000'010'000'010'000, 0b000'000'000'000'000,
    0b111'001'010'000'010};

}  // namespace

void set_pixel(media::Image& image, double x, double y, const Colour& colour) {
    if (!(x >= 0 && y >= 0 && x < image.width && y < image.height)) return;
    std::copy(colour.begin(), colour.end(), image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)));
}

void draw_line(media::Image& image, glm::dvec2 from, glm::dvec2 to, const Colour& colour, int width) {
    const double longest = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
    constexpr double kFarthest = 1e5;  // pixels; longer lines are left out
    if (!(longest < kFarthest)) return;
    const auto steps = std::max(1, static_cast<int>(std::ceil(longest)));
    for (int i = 0; i <= steps; ++i) {
        const glm::dvec2 at = glm::mix(from, to, static_cast<double>(i) / steps);
        for (int y = 0; y < width; ++y)
            for (int x = 0; x < width; ++x) set_pixel(image, at.x + x - width / 2, at.y + y - width / 2, colour);
    }
}

void draw_text(media::Image& image, int x, int y, const std::string& text, const Colour& colour, int dot) {
    for (const char c : text) {
        const char capital = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        const uint16_t dots = kDots[std::min(kCharacters.find(capital), kCharacters.size() - 1)];
        for (int i = 0; i < 15; ++i) {
            if (!(dots >> (14 - i) & 1)) continue;
            for (int p = 0; p < dot * dot; ++p)
                set_pixel(image, x + dot * (i % 3) + p % dot, y + dot * (i / 3) + p / dot, colour);
        }
        x += 4 * dot;
    }
}

}  // namespace neuvv::tools
