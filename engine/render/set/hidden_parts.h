// The parts of a set's images that nobody can see, because of a headset's lenses.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gpu/graphics_pass.h"

namespace neuvv::render {

// Owns the triangles of all views, and the pipeline that draws them, which is made when there are some for the first
// time.
class HiddenParts {
  public:
    // `corners` has the corners of triangles by view, as SetRaster::hide takes them. It writes memory that draws read.
    void set(const gpu::Device& device, std::span<const std::vector<glm::vec2>> corners);
    // Draws the triangles of a view nearer than everything else, so that nothing else is drawn there.
    void draw(gpu::Commands& commands, uint32_t view) const;

  private:
    std::unique_ptr<gpu::GraphicsPass> pass_;
    gpu::Buffer corners_;                                 // of all views
    std::vector<std::pair<uint32_t, uint32_t>> of_view_;  // (first corner, number of corners); empty: none are hidden
};

}  // namespace neuvv::render
