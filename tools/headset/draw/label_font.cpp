#include "tools/headset/draw/label_font.h"

#include <algorithm>

namespace neuvv::headset {

namespace {

constexpr glm::vec4 kPlate{0.012f, 0.014f, 0.017f, 0.92f}, kText{0.9f, 0.9f, 0.88f, 1};
constexpr double kMargin = 0.35;  // around the text, in lines

// Takes the first character of UTF-8 off a text. What is not UTF-8 becomes a question mark.
ImWchar take_letter(std::string_view& text) {
    const auto first = static_cast<unsigned char>(text.front());
    const size_t bytes = first < 0x80 ? 1 : first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 1;
    uint32_t letter = bytes == 1 ? first : first & (0x7fu >> bytes);
    bool is_letter = bytes <= text.size() && !(bytes == 1 && first >= 0x80);
    for (size_t i = 1; i < bytes && is_letter; ++i) {
        const auto next = static_cast<unsigned char>(text[i]);
        is_letter = (next & 0xc0) == 0x80;
        letter = letter << 6 | (next & 0x3f);
    }
    text.remove_prefix(is_letter ? bytes : 1);
    return is_letter && letter < 0x10000 ? static_cast<ImWchar>(letter) : ImWchar('?');
}

// Calls `each` with the glyphs of a line and the positions where they begin. Returns where the line ends.
template <typename Each>
double lay_out(const ImFont& font, std::string_view line, const Each& each) {
    double x = 0;
    for (int letters = 0; !line.empty(); ++letters) {
        const bool is_last = letters == LabelFont::kMaxLetters - 1;
        ImWchar letter = take_letter(line);
        if (is_last && !line.empty()) letter = 0x2026;  // …
        const ImFontGlyph& glyph = *font.FindGlyph(letter);
        each(glyph, x);
        x += glyph.AdvanceX;
        if (is_last) break;
    }
    return x;
}

}  // namespace

LabelFont::LabelFont(const gpu::Device& device) {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    atlas.GetTexDataAsAlpha8(&pixels, &width, &height);
    image_ = gpu::DeviceImage(device, "label font",
                              {static_cast<uint32_t>(width), static_cast<uint32_t>(height), VK_FORMAT_R8_UNORM,
                               VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    const std::vector<uint8_t> level(pixels, pixels + size_t{image_.shape.width} * image_.shape.height);
    gpu::upload_levels(device, image_, std::span(&level, 1));
    font_ = atlas.Fonts[0];
    plate_.low = plate_.high = {atlas.TexUvWhitePixel.x, atlas.TexUvWhitePixel.y};
}

LabelFont::~LabelFont() {
    image_.device->wait_idle_or_lost();  // frames may read the image
}

double LabelFont::width_of(std::string_view line) const {
    return lay_out(*font_, line, [](const ImFontGlyph&, double) {});
}

void LabelFont::draw(xr::EyeShapes& shapes, const xr::Pose& world_from_plate, double line_m,
                     std::span<const std::string_view> lines) const {
    double width = 0;
    for (const std::string_view line : lines) width = std::max(width, width_of(line));
    const double metres = line_m / font_->FontSize, margin = kMargin * line_m;
    const glm::dvec2 half(0.5 * width * metres, 0);
    const double top = line_m * static_cast<double>(lines.size()) + 2 * margin;
    shapes.text(world_from_plate, -half - glm::dvec2(margin, 0), half + glm::dvec2(margin, top), plate_, kPlate);
    for (size_t i = 0; i < lines.size(); ++i) {
        const double line_top = top - margin - line_m * static_cast<double>(i);
        lay_out(*font_, lines[i], [&](const ImFontGlyph& glyph, double x) {
            if (!glyph.Visible) return;
            const glm::dvec2 low(-half.x + (x + glyph.X0) * metres, line_top - glyph.Y1 * metres),
                high(-half.x + (x + glyph.X1) * metres, line_top - glyph.Y0 * metres);
            shapes.text(world_from_plate, low, high, {{glyph.U0, glyph.V0}, {glyph.U1, glyph.V1}}, kText);
        });
    }
}

}  // namespace neuvv::headset
