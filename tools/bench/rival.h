// The rival of `neuvv-bench render --rival raster`: leaves as sparse voxels in place of tile ranges and trace.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/frame.h"

namespace neuvv::bench {

struct RivalTimes {
    std::vector<double> project_ms, sort_ms, composite_ms;  // of each image
    std::vector<double> pairs;                              // of a tile and a leaf, of each view
    std::vector<double> differences, squares;               // from the shaded image, of each view: mean, mean square
};

// Draws the image that the renderer has just shaded, from the first of the slices that it keeps, so many times.
void measure_rival(const gpu::Device& device, const render::Field& field, const render::FrameRenderer& renderer,
                   const stage::Camera& camera, const media::Image& shaded, uint32_t repeats, RivalTimes& times);

// `trace_ms`: what the same rays take with tile ranges and trace.
std::string rival_text(const RivalTimes& times, double trace_ms);
nlohmann::ordered_json rival_json(const RivalTimes& times, double trace_ms);

}  // namespace neuvv::bench
