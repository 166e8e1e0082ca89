// Layers of an image for compositing, beside its light and depth: which performers cover each pixel, and deep samples.
#pragma once

#include <map>
#include <string>

#include "media/cryptomatte.h"
#include "render/rays/deep_pixel.h"
#include "stage/camera.h"

namespace neuvv::render {

// What a stage's set contributes to each ray, in rows of rays; empty: there is no set.
struct SetRays {
    std::vector<glm::vec4> behind, front;  // premultiplied light behind and before performers
    std::vector<float> axis_m;             // of the opaque set along the camera's axis; infinite where there is none
};

// Of all surfaces that are no performer's. Where a performer has this name, "_" is appended until none has it.
constexpr const char* kSetName = "set";

// Gathers the layers of one image from FrameRenderer::read_intervals.
class ImageLayers {
  public:
    struct Wanted {
        bool ids = false, deep = false;
    };
    // `names` has the name of each performer, `samples` the number of rays of a pixel along each side. The set must
    // outlive it; its surfaces are one name more, and samples of the deep image where they are opaque. What is blended
    // before performers has no depth and is not in the deep image.
    ImageLayers(const stage::Camera& camera, uint32_t samples, std::span<const std::string> names, const SetRays& set,
                Wanted wanted, float stop);

    // In the order of tiles.
    void add(glm::uvec2 ray, std::span<const RayInterval> intervals);
    // After the last ray.
    void finish() { finish_rows(camera_.height); }

    media::IdImage ids;
    media::DeepImage deep;

  private:
    using RowOfRays = std::vector<std::vector<RayInterval>>;  // of a row of pixels, pixel by pixel
    struct Pixel {
        std::array<media::IdRank, media::kIdRanks> ranks;
        std::vector<media::DeepSample> samples;
    };
    void finish_rows(uint32_t end);
    Pixel pixel_of(glm::uvec2 at, std::span<const std::vector<RayInterval>> rays) const;
    void add_set(MergedRay& ray, size_t index) const;

    stage::Camera camera_, rays_;
    uint32_t samples_;
    const SetRays& set_;
    Wanted wanted_;
    float stop_;
    std::vector<uint32_t> name_of_;  // by performer, and last that of the set: index into ids.names
    std::map<uint32_t, RowOfRays> rows_;
    uint32_t next_row_ = 0;
};

}  // namespace neuvv::render
