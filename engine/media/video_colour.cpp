#include "media/video_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "media/image.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace neuvv::media {

namespace {

constexpr double kWhite_nits = 203;     // BT.2408
constexpr double kHlgPeak_nits = 1000;  // of the display that BT.2100 names for HLG
constexpr double kHlgGamma = 1.2;       // of that display
constexpr double kScreenGamma = 2.4;    // BT.1886, of the screens that BT.709 is made for
constexpr float kMaxValue = 65535;

// BT.2087, and the same of Display P3 (SMPTE EG 432-1) and of DCI-P3 (SMPTE RP 431-2), whose white becomes that of sRGB
// by Bradford's method.
constexpr float kFrom2020[9] = {1.6605f, -0.5876f, -0.0728f, -0.1246f, 1.1329f, -0.0083f, -0.0182f, -0.1006f, 1.1187f};
constexpr float kFromP3[9] = {1.2249f, -0.2247f, 0, -0.0420f, 1.0419f, 0, -0.0197f, -0.0786f, 1.0979f};
constexpr float kFromDci[9] = {1.1575f, -0.1550f, -0.0026f, -0.0415f, 1.0456f, -0.0041f, -0.0181f, -0.0786f, 1.0966f};
constexpr float kSame[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

const float* gamut_of(AVColorPrimaries primaries) {
    switch (primaries) {
        case AVCOL_PRI_BT2020:
            return kFrom2020;
        case AVCOL_PRI_SMPTE431:
            return kFromDci;
        case AVCOL_PRI_SMPTE432:
            return kFromP3;
        default:
            return kSame;
    }
}

// BT.2100: light of the scene, 0 to 1, and the gamma of the display. The gamma is taken channel by channel, as screens
// of BT.709 have it and zimg does it, so that cameras of both kinds agree; BT.2100 takes it of the luminance, which is
// paler.
double hlg_light(double value) {
    const double a = 0.17883277, b = 1 - 4 * a, c = 0.5 - a * std::log(4 * a);
    const double scene = value <= 0.5 ? value * value / 3 : (std::exp((value - c) / a) + b) / 12;
    return kHlgPeak_nits / kWhite_nits * std::pow(scene, kHlgGamma);
}

// BT.2100: light of the display, where white is 1.
double pq_light(double value) {
    const double m1 = 2610.0 / 16384, m2 = 2523.0 / 32, c1 = 3424.0 / 4096, c2 = 2413.0 / 128, c3 = 2392.0 / 128;
    const double root = std::pow(value, 1 / m2);
    return 10000 / kWhite_nits * std::pow(std::max(root - c1, 0.0) / (c2 - c3 * root), 1 / m1);
}

double light_of(AVColorTransferCharacteristic transfer, double value) {
    switch (transfer) {
        case AVCOL_TRC_ARIB_STD_B67:
            return hlg_light(value);
        case AVCOL_TRC_SMPTE2084:
            return pq_light(value);
        case AVCOL_TRC_LINEAR:
            return value;
        default:
            return std::pow(value, kScreenGamma);
    }
}

// The byte of BT.1886 of light of 0 to 1. The table's steps are even in the root of light, which no byte spans less
// than four of.
uint8_t screen_byte(float light) {
    constexpr size_t kSteps = 4096;
    static const auto table = [] {
        std::array<uint8_t, kSteps + 1> bytes{};
        for (size_t i = 0; i <= kSteps; ++i) {
            const double root = static_cast<double>(i) / kSteps;
            bytes[i] = static_cast<uint8_t>(std::lround(255 * std::pow(root * root, 1 / kScreenGamma)));
        }
        return bytes;
    }();
    return table[static_cast<size_t>(std::sqrt(std::clamp(light, 0.0f, 1.0f)) * kSteps + 0.5f)];
}

bool is_known(AVColorTransferCharacteristic transfer) {
    return transfer != AVCOL_TRC_LOG && transfer != AVCOL_TRC_LOG_SQRT && transfer != AVCOL_TRC_SMPTE428;
}
// Of gamuts without a matrix above, those that are nearly that of sRGB.
bool is_known(AVColorPrimaries primaries) {
    constexpr AVColorPrimaries kKnown[] = {AVCOL_PRI_RESERVED0, AVCOL_PRI_BT709,   AVCOL_PRI_UNSPECIFIED,
                                           AVCOL_PRI_RESERVED,  AVCOL_PRI_BT470BG, AVCOL_PRI_SMPTE170M,
                                           AVCOL_PRI_SMPTE240M, AVCOL_PRI_EBU3213};
    return gamut_of(primaries) != kSame || std::ranges::find(kKnown, primaries) != std::end(kKnown);
}
// The matrices that libswscale has; VideoReader takes BT2020_CL as BT2020_NCL.
bool is_known(AVColorSpace matrix) {
    constexpr AVColorSpace kKnown[] = {
        AVCOL_SPC_RGB,     AVCOL_SPC_BT709,     AVCOL_SPC_UNSPECIFIED, AVCOL_SPC_RESERVED,   AVCOL_SPC_FCC,
        AVCOL_SPC_BT470BG, AVCOL_SPC_SMPTE170M, AVCOL_SPC_SMPTE240M,   AVCOL_SPC_BT2020_NCL, AVCOL_SPC_BT2020_CL};
    return std::ranges::find(kKnown, matrix) != std::end(kKnown);
}

// What of the stream's colours is not converted; empty where there is nothing.
std::string unconverted(const AVCodecParameters& stream) {
    const auto text = [](const char* what, const char* name) { return fmt::format("{} {}", what, name ? name : "?"); };
    if (!is_known(stream.color_trc)) return text("transfer function", av_color_transfer_name(stream.color_trc));
    if (!is_known(stream.color_space)) return text("matrix", av_color_space_name(stream.color_space));
    if (!is_known(stream.color_primaries)) return text("primaries", av_color_primaries_name(stream.color_primaries));
    return {};
}

}  // namespace

std::optional<VideoColour> VideoColour::of(AVColorTransferCharacteristic transfer, AVColorPrimaries primaries) {
    const bool usual =
        transfer != AVCOL_TRC_ARIB_STD_B67 && transfer != AVCOL_TRC_SMPTE2084 && transfer != AVCOL_TRC_LINEAR;
    if (usual && gamut_of(primaries) == kSame) return {};
    return VideoColour(transfer, primaries);
}

VideoColour::VideoColour(AVColorTransferCharacteristic transfer, AVColorPrimaries primaries)
    : gamut_(gamut_of(primaries)),
      byte_of_(transfer == AVCOL_TRC_LINEAR ? srgb_byte_from_linear : screen_byte),
      light_(size_t{1} << 16) {
    for (size_t i = 0; i < light_.size(); ++i)
        light_[i] = static_cast<float>(light_of(transfer, static_cast<double>(i) / kMaxValue));
}

void VideoColour::to_srgb(const uint16_t* rgba, uint8_t* srgb, size_t pixels) const {
    for (const uint16_t* end = rgba + 4 * pixels; rgba != end; rgba += 4, srgb += 4) {
        const float light[3] = {light_[rgba[0]], light_[rgba[1]], light_[rgba[2]]};
        for (size_t c = 0; c < 3; ++c)
            srgb[c] = byte_of_(gamut_[3 * c] * light[0] + gamut_[3 * c + 1] * light[1] + gamut_[3 * c + 2] * light[2]);
        srgb[3] = static_cast<uint8_t>(rgba[3] >> 8);
    }
}

std::string colour_note(const AVCodecParameters& stream) {
    if (const std::string what = unconverted(stream); !what.empty())
        return fmt::format("has colours by the {}, which are not converted: they are wrong", what);
    if (!VideoColour::of(stream.color_trc, stream.color_primaries)) return {};
    const char* transfer = stream.color_trc == AVCOL_TRC_ARIB_STD_B67 ? "HLG"
                           : stream.color_trc == AVCOL_TRC_SMPTE2084  ? "PQ"
                           : stream.color_trc == AVCOL_TRC_LINEAR     ? "linear light"
                                                                      : "";
    const float* from = gamut_of(stream.color_primaries);
    const char* gamut = from == kFrom2020  ? "BT.2020"
                        : from == kFromDci ? "DCI-P3"
                        : from == kFromP3  ? "Display P3"
                                           : "";
    const bool bright = stream.color_trc == AVCOL_TRC_ARIB_STD_B67 || stream.color_trc == AVCOL_TRC_SMPTE2084;
    return fmt::format("{}{}{}, converted to sRGB{}", transfer, *transfer && *gamut ? " in " : "", gamut,
                       bright ? "; what is brighter than white (203 cd/m²) is clipped" : "");
}

}  // namespace neuvv::media
