#include "tools/image_drawing.h"

#include <stb/stb_truetype.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "tools/ui/fonts.h"

namespace neuvv::tools {

namespace {

// The letters of the window.
const stbtt_fontinfo& font() {
    static const stbtt_fontinfo opened = [] {
        stbtt_fontinfo info;
        [[maybe_unused]] const int good = stbtt_InitFont(&info, ui::roboto_font().data(), 0);
        assert(good && "the font in the program is whole");
        return info;
    }();
    return opened;
}

// The code points of UTF-8; of other bytes, one question mark each.
std::vector<int> code_points(const std::string& text) {
    std::vector<int> points;
    for (size_t i = 0; i < text.size();) {
        const auto first = static_cast<unsigned char>(text[i++]);
        const int more = first < 0x80 ? 0 : first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : -1;
        int point = more < 0 ? '?' : first & (more == 0 ? 0x7f : 0x3f >> more);
        for (int k = 0; k < more; ++k) {
            const bool continues = i < text.size() && (text[i] & 0xc0) == 0x80;
            point = continues && point != '?' ? point << 6 | (text[i] & 0x3f) : '?';
            i += continues;
        }
        points.push_back(point);
    }
    return points;
}

double advance(int point, float scale) {
    int width = 0, bearing = 0;
    stbtt_GetCodepointHMetrics(&font(), point, &width, &bearing);
    return static_cast<double>(width) * scale;
}

void blend(media::Image& image, int x, int y, const Colour& colour, uint8_t coverage) {
    if (x < 0 || y < 0 || x >= static_cast<int>(image.width) || y >= static_cast<int>(image.height)) return;
    uint8_t* pixel = image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y));
    for (size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<uint8_t>((pixel[c] * (255 - coverage) + colour[c] * coverage + 127) / 255);
}

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

double text_width(const std::string& text, int height) {
    const float scale = stbtt_ScaleForPixelHeight(&font(), static_cast<float>(height));
    double width = 0;
    for (const int point : code_points(text)) width += advance(point, scale);
    return width;
}

void draw_text(media::Image& image, int x, int y, const std::string& text, const Colour& colour, int height) {
    const float scale = stbtt_ScaleForPixelHeight(&font(), static_cast<float>(height));
    int ascent = 0, descent = 0, gap = 0;
    stbtt_GetFontVMetrics(&font(), &ascent, &descent, &gap);
    const int base = y + static_cast<int>(std::lround(static_cast<float>(ascent) * scale));
    double at = x;
    std::vector<uint8_t> glyph;
    for (const int point : code_points(text)) {
        const auto fraction = static_cast<float>(at - std::floor(at));
        int left = 0, top = 0, right = 0, bottom = 0;
        stbtt_GetCodepointBitmapBoxSubpixel(&font(), point, scale, scale, fraction, 0, &left, &top, &right, &bottom);
        const int width = right - left, rows = bottom - top;
        glyph.assign(static_cast<size_t>(std::max(width, 0)) * static_cast<size_t>(std::max(rows, 0)), 0);
        if (!glyph.empty())
            stbtt_MakeCodepointBitmapSubpixel(&font(), glyph.data(), width, rows, width, scale, scale, fraction, 0,
                                              point);
        for (int i = 0; i < static_cast<int>(glyph.size()); ++i)
            blend(image, static_cast<int>(std::floor(at)) + left + i % width, base + top + i / width, colour,
                  glyph[static_cast<size_t>(i)]);
        at += advance(point, scale);
    }
}

}  // namespace neuvv::tools
