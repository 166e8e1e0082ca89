// Frame passes: the intermediate buffers of a frame, each as an image of one number a ray, a tile or a texel.
//
// The table in frame_passes.cpp has a row for each buffer; `neuvv render --pass NAME` shows it.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "render/frame/frame_renderer.h"

namespace neuvv::render {

// The numbers of a buffer, in rows; NaN where the buffer has no number.
struct PassValues {
    uint32_t width = 0, height = 0;
    std::vector<float> values;
};

struct FramePass {
    const char* name;
    const char* shows;  // a line that describes the numbers
    const char* unit;
    bool needs_set;  // whether the buffer exists only where a stage with its set is drawn
    PassValues (*read)(const FrameRenderer& renderer);  // from the first view of the last frame
};

// All passes of the table, in the order in which a frame writes them.
std::span<const FramePass> frame_passes();
// Null where no pass has that name.
const FramePass* find_frame_pass(std::string_view name);

// The smallest and the largest number; nothing where there are no numbers.
std::optional<std::pair<float, float>> range_of(const PassValues& values);

// The numbers as colours of the map viridis: dark at the lower end of the range, bright at the upper end. Pixels
// without a number are transparent.
media::Image colour_mapped(const PassValues& values, std::pair<float, float> range);

}  // namespace neuvv::render
