// Light of videos that is encoded otherwise than for the usual screens: HLG and PQ (ITU-R BT.2100), and the wide gamuts
// of BT.2020, Display P3 and DCI-P3. Those of BT.709 and BT.601 are taken as sRGB, as players show them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "media/libav.h"

namespace neuvv::media {

class VideoColour {
  public:
    // Nothing where the values of this transfer function and these primaries are taken as sRGB.
    static std::optional<VideoColour> of(AVColorTransferCharacteristic transfer, AVColorPrimaries primaries);

    // Converts pixels, R, G, B and A of 16 bits, to 8 bits of sRGB. White is the diffuse white of BT.2408, 203 cd/m²:
    // what is brighter, and colours outside of sRGB's gamut, are clipped. Linear light is encoded by sRGB's function;
    // all other light as for the usual screens (BT.1886), which is taken as sRGB as the usual video is.
    void to_srgb(const uint16_t* rgba, uint8_t* srgb, size_t pixels) const;

  private:
    VideoColour(AVColorTransferCharacteristic transfer, AVColorPrimaries primaries);

    const float* gamut_;         // 3×3, row by row: linear light of sRGB's primaries from that of the video's
    uint8_t (*byte_of_)(float);  // of light of 0 to 1
    std::vector<float> light_;   // of each of 65536 values
};

// What of it is converted or cannot be, for the remarks about a file; empty where there is nothing to say.
std::string colour_note(const AVCodecParameters& stream);

}  // namespace neuvv::media
