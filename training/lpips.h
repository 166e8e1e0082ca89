// LPIPS: how different two images look to a network trained for recognition, calibrated by what people said (Zhang et
// al., "The Unreasonable Effectiveness of Deep Features as a Perceptual Metric", 2018; version 0.1, AlexNet). The
// weights are not ours to give: the user exports them (training/README.md says how).
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "media/image.h"

namespace neuvv::training {

constexpr size_t kLpipsLayers = 5;

class Lpips {
  public:
    // An .npz of float32 arrays under the names of the lpips package's state dictionary: net.sliceS.I.weight (out, in,
    // k, k) and .bias (out) of AlexNet's five convolutions, linL.model.1.weight (1, out, 1, 1). Others are ignored.
    // Throws InputError for arrays that are missing or of another shape.
    explicit Lpips(const std::filesystem::path& weights);

    // 0 for equal images. Of one size (assert), alpha ignored; throws InputError for images below
    // kLeastSide pixels a side, of which the network's last layers see nothing.
    static constexpr uint32_t kMinSide = 32;
    double distance(const media::Image& a, const media::Image& b) const;

  private:
    struct Layer {
        uint32_t in = 0, out = 0;
        std::vector<float> kernel, bias;  // kernel: out × (in × k × k)
        std::vector<float> importance;    // of each channel
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
