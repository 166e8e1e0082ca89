#include "training/evaluation/lpips.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/error.h"
#include "base/formats/npz.h"
#include "base/threads/parallel.h"

namespace neuvv::training {

namespace {

// AlexNet's convolutions as in torchvision: their names in LPIPS, and their geometry.
struct Geometry {
    const char* name;
    uint32_t kernel, stride, padding;
    bool pooled_before;
};
constexpr Geometry kGeometry[kLpipsLayers] = {{"net.slice1.0", 11, 4, 2, false},
                                              {"net.slice2.3", 5, 1, 2, true},
                                              {"net.slice3.6", 3, 1, 1, true},
                                              {"net.slice4.8", 3, 1, 1, false},
                                              {"net.slice5.10", 3, 1, 1, false}};
constexpr uint32_t kPoolSize = 3, kPoolStride = 2;
constexpr float kShift[3] = {-0.030f, -0.088f, -0.188f}, kScale[3] = {0.458f, 0.448f, 0.450f};  // for values in [−1,1]
constexpr double kNormFloor = 1e-10;
constexpr uint32_t kMaxChannels = 4096;
constexpr uint32_t kColumns = 16, kRows = 4;  // outputs computed together: as many as fit a CPU's vector registers

std::string text_of(const std::vector<uint64_t>& shape) {
    return fmt::format("({})", fmt::join(shape, ", "));
}

const FloatArray& array_of(const std::map<std::string, FloatArray>& arrays, const std::string& file,
                           const std::string& name, const std::vector<uint64_t>& shape) {
    const auto found = arrays.find(name);
    if (found == arrays.end())
        throw InputError(file, name, "is missing", "export the weights as training/evaluation/README.md says");
    if (found->second.shape != shape)
        throw InputError(file, name,
                         fmt::format("has the shape {} instead of {}", text_of(found->second.shape), text_of(shape)),
                         "export the weights of LPIPS 0.1 with AlexNet");
    return found->second;
}

}  // namespace

Lpips::Lpips(const std::filesystem::path& weights) {
    const std::map<std::string, FloatArray> arrays = read_npz(weights);
    const std::string file = weights.string();
    uint32_t in = 3;
    for (size_t i = 0; i < kLpipsLayers; ++i) {
        const Geometry& g = kGeometry[i];
        Layer& layer = layers_[i];
        const auto kernel = arrays.find(std::string(g.name) + ".weight");
        layer.in = in;  // a missing or empty kernel is refused below, by its shape
        const bool shapeless = kernel == arrays.end() || kernel->second.shape.empty();
        layer.out =
            static_cast<uint32_t>(std::clamp<uint64_t>(shapeless ? 1 : kernel->second.shape[0], 1, kMaxChannels));
        layer.kernel =
            array_of(arrays, file, std::string(g.name) + ".weight", {layer.out, in, g.kernel, g.kernel}).values;
        layer.bias = array_of(arrays, file, std::string(g.name) + ".bias", {layer.out}).values;
        layer.importance = array_of(arrays, file, fmt::format("lin{}.model.1.weight", i), {1, layer.out, 1, 1}).values;
        in = layer.out;
    }
}

Lpips::Planes Lpips::input(const media::Image& image) {
    Planes planes{3, image.width, image.height, std::vector<float>(image.rgba.size() / 4 * 3)};
    const size_t pixels = image.rgba.size() / 4;
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < pixels; ++i)
            planes.values[c * pixels + i] =
                (static_cast<float>(image.rgba[4 * i + c]) / 127.5f - 1 - kShift[c]) / kScale[c];
    return planes;
}

// Convolution, then ReLU. The output is computed in strips of kColumns pixels of a row: the inputs of a strip are
// gathered as a matrix, which is multiplied by the kernels.
Lpips::Planes Lpips::convolved(const Planes& in, const Layer& layer, size_t index) {
    const Geometry& g = kGeometry[index];
    Planes out{layer.out,
               (in.width + 2 * g.padding - g.kernel) / g.stride + 1,
               (in.height + 2 * g.padding - g.kernel) / g.stride + 1,
               {}};
    out.values.resize(size_t{out.channels} * out.width * out.height);
    const size_t taps = size_t{layer.in} * g.kernel * g.kernel;
    const uint32_t strips = (out.width + kColumns - 1) / kColumns;
    const auto pixel = [&](uint32_t channel, int64_t x, int64_t y) {
        const bool inside = x >= 0 && y >= 0 && x < in.width && y < in.height;
        return inside ? in.values[(size_t{channel} * in.height + static_cast<size_t>(y)) * in.width +
                                  static_cast<size_t>(x)]
                      : 0.0f;
    };
    const auto run_strip = [&](uint32_t y, uint32_t left, std::vector<float>& seen) {
        float* to = seen.data();
        for (uint32_t c = 0; c < layer.in; ++c)
            for (uint32_t v = 0; v < g.kernel; ++v)
                for (uint32_t u = 0; u < g.kernel; ++u)
                    for (uint32_t x = 0; x < kColumns; ++x)
                        *to++ = pixel(c, int64_t{left + x} * g.stride + u - g.padding,
                                      int64_t{y} * g.stride + v - g.padding);
        const uint32_t columns = std::min(kColumns, out.width - left);
        for (uint32_t first = 0; first < layer.out; first += kRows) {
            const uint32_t rows = std::min(kRows, layer.out - first);
            float sums[kRows][kColumns] = {};
            for (size_t k = 0; k < taps; ++k)
                for (uint32_t r = 0; r < kRows; ++r) {
                    const float weight = layer.kernel[(first + std::min(r, rows - 1)) * taps + k];
                    for (uint32_t x = 0; x < kColumns; ++x) sums[r][x] += weight * seen[k * kColumns + x];
                }
            for (uint32_t r = 0; r < rows; ++r)
                for (uint32_t x = 0; x < columns; ++x)
                    out.values[(size_t{first + r} * out.height + y) * out.width + left + x] =
                        std::max(0.0f, sums[r][x] + layer.bias[first + r]);
        }
    };
    parallel_for(size_t{out.height} * strips, 4, [&](size_t begin, size_t end) {
        std::vector<float> seen(taps * kColumns);
        for (size_t i = begin; i < end; ++i)
            run_strip(static_cast<uint32_t>(i / strips), static_cast<uint32_t>(i % strips) * kColumns, seen);
    });
    return out;
}

Lpips::Planes Lpips::pooled(const Planes& in) {
    Planes out{in.channels, (in.width - kPoolSize) / kPoolStride + 1, (in.height - kPoolSize) / kPoolStride + 1, {}};
    out.values.reserve(size_t{out.channels} * out.width * out.height);
    for (uint32_t c = 0; c < out.channels; ++c)
        for (uint32_t y = 0; y < out.height; ++y)
            for (uint32_t x = 0; x < out.width; ++x) {
                float largest = 0;  // inputs are never negative
                for (uint32_t v = 0; v < kPoolSize; ++v)
                    for (uint32_t u = 0; u < kPoolSize; ++u)
                        largest = std::max(
                            largest,
                            in.values[(size_t{c} * in.height + y * kPoolStride + v) * in.width + x * kPoolStride + u]);
                out.values.push_back(largest);
            }
    return out;
}

// The mean over pixels of the weighted squared difference of features, which are scaled to length 1 at each pixel.
double Lpips::difference(const Planes& a, const Planes& b, const std::vector<float>& importance) {
    const size_t pixels = size_t{a.width} * a.height;
    double sum = 0;
    for (size_t i = 0; i < pixels; ++i) {
        double length_a = 0, length_b = 0;
        for (size_t c = 0; c < a.channels; ++c) {
            length_a += double{a.values[c * pixels + i]} * double{a.values[c * pixels + i]};
            length_b += double{b.values[c * pixels + i]} * double{b.values[c * pixels + i]};
        }
        const double scale_a = 1 / (std::sqrt(length_a) + kNormFloor), scale_b = 1 / (std::sqrt(length_b) + kNormFloor);
        for (size_t c = 0; c < a.channels; ++c) {
            const double d = double{a.values[c * pixels + i]} * scale_a - double{b.values[c * pixels + i]} * scale_b;
            sum += double{importance[c]} * d * d;
        }
    }
    return sum / static_cast<double>(pixels);
}

double Lpips::distance(const media::Image& a, const media::Image& b) const {
    assert(a.width == b.width && a.height == b.height && "images to compare have one size");
    if (std::min(a.width, a.height) < kMinSide)
        throw InputError(
            Setting{"lpips"}, "",
            fmt::format("the images are {}×{}, and LPIPS needs {} pixels a side", a.width, a.height, kMinSide),
            "leave it out");
    Planes of_a = input(a), of_b = input(b);
    double sum = 0;
    for (size_t i = 0; i < kLpipsLayers; ++i) {
        for (Planes* planes : {&of_a, &of_b}) {
            if (kGeometry[i].pooled_before) *planes = pooled(*planes);
            *planes = convolved(*planes, layers_[i], i);
        }
        sum += difference(of_a, of_b, layers_[i].importance);
    }
    return sum;
}

}  // namespace neuvv::training
