// Frame passes: the intermediate buffers of a frame, each as an image of one number a ray, a tile or a texel.
//
// The table in frame_passes.cpp has a row for each buffer; `neuvv render --pass NAME` shows them.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "render/frame.h"

namespace neuvv::render {

// The numbers of a buffer in rows; NaN where it holds nothing.
struct PassValues {
    uint32_t width = 0, height = 0;
    std::vector<float> values;
};

struct FramePass {
    const char* name;
    const char* shows;  // one line
    const char* unit;
    bool needs_set;                                     // there is one only where a stage is drawn
    PassValues (*read)(const FrameRenderer& renderer);  // of the first view of the last frame
};

// All of them, in the order in which the frame makes them.
std::span<const FramePass> frame_passes();
// Null where there is none of that name.
const FramePass* find_frame_pass(std::string_view name);

// The least and the largest number; nothing where the buffer holds none.
std::optional<std::pair<float, float>> range_of(const PassValues& values);

// The numbers by the colour map viridis: dark is the lower end of the range, bright the upper one. Clear where there is
// nothing.
media::Image colour_mapped(const PassValues& values, std::pair<float, float> range);

}  // namespace neuvv::render
