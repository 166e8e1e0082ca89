// What `neuvv-bench render` compares the renderer with: the same rays by plain C++ on all cores (cpu_marcher.cpp), and
// with --rival raster leaves that are rasterised in place of tile ranges and trace (rival.cpp).
#pragma once

#include "tools/bench/measure.h"

namespace neuvv::bench {

// What rays have read, counted as the device reads it, whose walks begin at the grid over the upper levels.
struct MarchCounts {
    uint64_t rays = 0;       // in tiles that may see a leaf
    uint64_t nodes = 0;      // entered
    uint64_t descents = 0;   // steps from a node to its child, below the nodes that the grid names
    uint64_t entries = 0;    // read at leaves
    uint64_t bytes() const;  // read and written
    void add(const MarchCounts& other);
};

struct HostTimes {
    std::vector<double> ms;       // of the rays alone
    double worst_difference = 0;  // between host and device, in alpha or colour of a ray
    MarchCounts counts;
    uint32_t images = 0;  // in `counts`
};

// Traces the rays of the image that the renderer has just shaded again on the host, `repeats` times, and adds to
// `host`.
void measure_host(const gpu::Device& device, const render::Field& field, const render::FrameRenderer& renderer,
                  const stage::Camera& camera, uint32_t repeats, HostTimes& host);

struct RivalTimes {
    std::vector<PassSum> passes;
    std::vector<double> pairs;  // of a tile and a leaf, of each view
    Differences differences;    // from the shaded images
};

// Draws the image that the renderer has just shaded again, `repeats` times, from the first slice of the renderer's
// cache, and adds to `times`.
void measure_rival(const gpu::Device& device, const render::Field& field, const render::FrameRenderer& renderer,
                   const stage::Camera& camera, const media::Image& shaded, uint32_t repeats, RivalTimes& times);

// `trace_ms`: the time of tile ranges and trace for the same rays.
std::string rival_text(const RivalTimes& times, double trace_ms);
nlohmann::ordered_json rival_json(const RivalTimes& times, double trace_ms);

}  // namespace neuvv::bench
