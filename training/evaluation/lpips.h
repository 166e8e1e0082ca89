// LPIPS: how different two images look to a network trained for recognition, calibrated by people's judgements (Zhang
// et al., "The Unreasonable Effectiveness of Deep Features as a Perceptual Metric", 2018; version 0.1, AlexNet). The
// network's weights are not part of NeuVV: the user exports them (training/evaluation/README.md says how).
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "media/image.h"

namespace neuvv::training {

constexpr size_t kLpipsLayers = 5;

class Lpips {
  public:
    // Reads an .npz of float32 arrays with the names of the lpips package's state dictionary: net.sliceS.I.weight (out,
    // in, k, k) and .bias (out) of AlexNet's five convolutions, and linL.model.1.weight (1, out, 1, 1). Other arrays
    // are ignored. Throws InputError for arrays that are missing or of another shape.
    explicit Lpips(const std::filesystem::path& weights);

    // 0 for equal images. They must have one size (assert); alpha is ignored. Throws InputError for images with a side
    // below kMinSide pixels, which are too small for the network's last layers.
    static constexpr uint32_t kMinSide = 32;
    double distance(const media::Image& a, const media::Image& b) const;

  private:
    struct Layer {
        uint32_t in = 0, out = 0;
        std::vector<float> kernel, bias;  // kernel: out × (in × k × k)
        std::vector<float> importance;    // one weight per channel
    };
    struct Planes {
        uint32_t channels = 0, width = 0, height = 0;
        std::vector<float> values;
    };
    static Planes input(const media::Image& image);
    static Planes convolved(const Planes& in, const Layer& layer, size_t index);
    static Planes pooled(const Planes& in);
    static double difference(const Planes& a, const Planes& b, const std::vector<float>& importance);

    std::array<Layer, kLpipsLayers> layers_;
};

}  // namespace neuvv::training
