// The measurement of `neuvv-bench render --rival raster`: leaves are rasterised in place of tile ranges and trace.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/frame.h"

namespace neuvv::bench {

struct RivalTimes {
    std::vector<double> project_ms, sort_ms, composite_ms;  // of each image drawn
    std::vector<double> pairs;                              // pairs of a tile and a leaf, of each view
    std::vector<double> differences, squares;  // of each view, from the shaded image: mean absolute, mean squared
};

// Draws the image that the renderer has just shaded again, `repeats` times, from the first slice of the renderer's
// cache, and adds to `times`.
void measure_rival(const gpu::Device& device, const render::Field& field, const render::FrameRenderer& renderer,
                   const stage::Camera& camera, const media::Image& shaded, uint32_t repeats, RivalTimes& times);

// `trace_ms`: the time of tile ranges and trace for the same rays.
std::string rival_text(const RivalTimes& times, double trace_ms);
nlohmann::ordered_json rival_json(const RivalTimes& times, double trace_ms);

}  // namespace neuvv::bench
