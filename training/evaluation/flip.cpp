#include "training/evaluation/flip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <numbers>

#include "base/threads/parallel.h"

namespace neuvv::training {
namespace {

using std::numbers::pi;
const glm::dvec3 kD65{0.950428545, 1.0, 1.088900371};  // D65 in XYZ
constexpr size_t kRowsAtATime = 8;
constexpr uint32_t kLanes = 16;  // pixels filtered together: the compiler makes vector instructions of a fixed count

glm::dvec3 xyz_from_rgb(glm::dvec3 c) {
    return {(10135552.0 * c.r + 8788810.0 * c.g + 4435075.0 * c.b) / 24577794.0,
            (2613072.0 * c.r + 8788810.0 * c.g + 887015.0 * c.b) / 12288897.0,
            (1425312.0 * c.r + 8788810.0 * c.g + 70074185.0 * c.b) / 73733382.0};
}

// From linear RGB to XYZ relative to white, and back.
const glm::mat3 kRelativeXyzFromRgb{xyz_from_rgb({1, 0, 0}) / kD65, xyz_from_rgb({0, 1, 0}) / kD65,
                                    xyz_from_rgb({0, 0, 1}) / kD65};
const glm::mat3 kRgbFromRelativeXyz = glm::inverse(glm::dmat3(kRelativeXyzFromRgb));

// YCxCz: linear in light, one channel of luminance and two of opponent colours.
glm::vec3 opponent_from_rgb(glm::vec3 rgb) {
    const glm::vec3 c = kRelativeXyzFromRgb * rgb;
    return {116 * c.y - 16, 500 * (c.x - c.y), 200 * (c.y - c.z)};
}

glm::vec3 rgb_from_opponent(glm::vec3 c) {
    const float y = (c.x + 16) / 116;
    return kRgbFromRelativeXyz * glm::vec3(c.y / 500 + y, y, y - c.z / 200);
}

// CIE L*a*b*, in which a* and b* are reduced in the dark (Hunt effect).
glm::vec3 hunt_lab(glm::vec3 rgb) {
    glm::vec3 c = kRelativeXyzFromRgb * rgb;
    constexpr float kDelta = 6.0f / 29;
    for (int i = 0; i < 3; ++i)
        c[i] = c[i] > kDelta * kDelta * kDelta ? std::cbrt(c[i]) : c[i] / (3 * kDelta * kDelta) + 4.0f / 29;
    const float lightness = 116 * c.y - 16;
    return {lightness, 0.01f * lightness * 500 * (c.x - c.y), 0.01f * lightness * 200 * (c.y - c.z)};
}

float hyab(glm::vec3 a, glm::vec3 b) {
    return std::abs(a.x - b.x) + glm::length(glm::vec2(a.y - b.y, a.z - b.z));
}

// One number per pixel. A row may be read up to kLanes numbers beyond its end.
struct Plane {
    uint32_t width = 0, height = 0;
    std::vector<float> values;

    Plane(uint32_t w, uint32_t h) : width(w), height(h), values(size_t{w} * h + kLanes) {}
    float* row(uint32_t y) { return &values[size_t{y} * width]; }
    const float* row(uint32_t y) const { return &values[size_t{y} * width]; }
};

void for_each_row(uint32_t height, const std::function<void(uint32_t y)>& run) {
    parallel_for(height, kRowsAtATime, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y) run(static_cast<uint32_t>(y));
    });
}

using Kernel = std::vector<float>;  // odd length, centre in the middle

Kernel kernel_of(int radius, const std::function<double(double)>& f) {
    Kernel kernel;
    for (int i = -radius; i <= radius; ++i) kernel.push_back(static_cast<float>(f(i)));
    return kernel;
}

// out[x] = Σ kernel[i]·rows[i][x]
void weighted_sum(const Kernel& kernel, const std::vector<const float*>& rows, uint32_t width, float* out) {
    for (uint32_t x = 0; x < width; x += kLanes) {
        float sums[kLanes] = {};
        for (size_t i = 0; i < kernel.size(); ++i) {
            const float *row = rows[i] + x, weight = kernel[i];
            for (uint32_t lane = 0; lane < kLanes; ++lane) sums[lane] += weight * row[lane];
        }
        std::copy_n(sums, std::min(kLanes, width - x), out + x);
    }
}

// Filters each row; beyond the edge, the pixel at the edge is repeated.
Plane along_x(const Plane& in, const Kernel& kernel) {
    Plane out(in.width, in.height);
    const size_t radius = kernel.size() / 2;
    for_each_row(in.height, [&](uint32_t y) {
        std::vector<float> padded(in.width + 2 * radius + kLanes, in.row(y)[in.width - 1]);
        std::fill_n(padded.begin(), radius, in.row(y)[0]);
        std::copy_n(in.row(y), in.width, &padded[radius]);
        std::vector<const float*> shifted;
        for (size_t i = 0; i < kernel.size(); ++i) shifted.push_back(&padded[i]);
        weighted_sum(kernel, shifted, in.width, out.row(y));
    });
    return out;
}

Plane along_y(const Plane& in, const Kernel& kernel) {
    Plane out(in.width, in.height);
    const auto radius = static_cast<int64_t>(kernel.size() / 2);
    for_each_row(in.height, [&](uint32_t y) {
        std::vector<const float*> rows;
        for (int64_t i = -radius; i <= radius; ++i)
            rows.push_back(in.row(static_cast<uint32_t>(std::clamp<int64_t>(y + i, 0, int64_t{in.height} - 1))));
        weighted_sum(kernel, rows, in.width, out.row(y));
    });
    return out;
}

using LabImage = std::array<Plane, 3>;

LabImage opponent_image(const media::Image& image) {
    const Plane empty(image.width, image.height);
    LabImage out{empty, empty, empty};
    for_each_row(image.height, [&](uint32_t y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const uint8_t* rgb = image.at(x, y);
            const glm::vec3 c =
                opponent_from_rgb({media::linear_from_srgb_byte(rgb[0]), media::linear_from_srgb_byte(rgb[1]),
                                   media::linear_from_srgb_byte(rgb[2])});
            for (int i = 0; i < 3; ++i) out[static_cast<size_t>(i)].row(y)[x] = c[i];
        }
    });
    return out;
}

// One term a·sqrt(π/b)·exp(−π² d²/b) of a contrast sensitivity function, d in degrees.
struct SensitivityTerm {
    double a, b;
};
const std::array<std::vector<SensitivityTerm>, 3> kSensitivities{
    {{{1, 0.0047}}, {{1, 0.0053}}, {{34.1, 0.04}, {13.5, 0.025}}}};

// A channel blurred by its contrast sensitivity function, the weights of which sum to 1.
Plane blurred(const Plane& in, const std::vector<SensitivityTerm>& terms, double pixels_per_degree) {
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    Plane out(in.width, in.height);
    double whole = 0;
    for (const auto& [a, b] : terms) {
        const Kernel kernel = kernel_of(radius, [&, b = b](double x) {
            return std::exp(-pi * pi * x * x / (pixels_per_degree * pixels_per_degree * b));
        });
        double sum = 0;
        for (const float value : kernel) sum += double{value};
        const double height = a * std::sqrt(pi / b);
        whole += height * sum * sum;
        const Plane part = along_y(along_x(in, kernel), kernel);
        for (size_t i = 0; i < out.values.size(); ++i) out.values[i] += static_cast<float>(height) * part.values[i];
    }
    for (float& value : out.values) value /= static_cast<float>(whole);
    return out;
}

// What a viewer sees of an image at this distance, in the colours of hunt_lab.
LabImage as_seen(const LabImage& opponent, double pixels_per_degree) {
    LabImage out{blurred(opponent[0], kSensitivities[0], pixels_per_degree),
                 blurred(opponent[1], kSensitivities[1], pixels_per_degree),
                 blurred(opponent[2], kSensitivities[2], pixels_per_degree)};
    for_each_row(out[0].height, [&](uint32_t y) {
        for (uint32_t x = 0; x < out[0].width; ++x) {
            const glm::vec3 c(out[0].row(y)[x], out[1].row(y)[x], out[2].row(y)[x]);
            const glm::vec3 lab = hunt_lab(glm::clamp(rgb_from_opponent(c), 0.0f, 1.0f));
            for (int i = 0; i < 3; ++i) out[static_cast<size_t>(i)].row(y)[x] = lab[i];
        }
    });
    return out;
}

// The kernel scaled so that its positive values sum to 1 and its negative values, where there are any, to −1.
Kernel normalised(Kernel kernel) {
    float positive = 0, negative = 0;
    for (const float value : kernel) (value > 0 ? positive : negative) += value;
    for (float& value : kernel) value /= value > 0 ? positive : -negative;
    return kernel;
}

// Strength of edges and of points in the luminance.
struct Features {
    Plane edges, points;
};

Plane lengths(Plane x, const Plane& y) {
    for (size_t i = 0; i < x.values.size(); ++i) x.values[i] = std::hypot(x.values[i], y.values[i]);
    return x;
}

Features features(Plane grey, double pixels_per_degree) {
    const double deviation = 0.5 * 0.082 * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto bell = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
    const Kernel smooth = normalised(kernel_of(radius, bell));
    const Kernel edge = normalised(kernel_of(radius, [&](double x) { return -x * bell(x); }));
    const Kernel point =
        normalised(kernel_of(radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * bell(x); }));
    for (float& value : grey.values) value = (value + 16) / 116;
    const Plane smooth_x = along_x(grey, smooth);
    return {lengths(along_y(along_x(grey, edge), smooth), along_y(smooth_x, edge)),
            lengths(along_y(along_x(grey, point), smooth), along_y(smooth_x, point))};
}

// HyAB difference as an error in [0,1]; large differences are compressed into the top twentieth.
float colour_error(glm::vec3 a, glm::vec3 b) {
    constexpr float kExponent = 0.7f, kKnee = 0.4f, kAtKnee = 0.95f;
    static const float largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kExponent);
    const float error = std::pow(hyab(a, b), kExponent), knee = kKnee * largest;
    return error < knee ? error * kAtKnee / knee
                        : std::min(1.0f, kAtKnee + (error - knee) / (largest - knee) * (1 - kAtKnee));
}

// matplotlib's colour map magma at multiples of 1/9, sRGB.
constexpr uint8_t kMagma[][3] = {{0, 0, 4},      {24, 15, 62},  {69, 16, 119},   {114, 31, 129},  {159, 47, 127},
                                 {205, 64, 113}, {241, 96, 93}, {253, 149, 103}, {254, 201, 141}, {252, 253, 191}};

}  // namespace

std::vector<float> flip(const media::Image& a, const media::Image& b, double pixels_per_degree) {
    assert(a.width == b.width && a.height == b.height && "images to compare have one size");
    const LabImage opponent_a = opponent_image(a), opponent_b = opponent_image(b);
    const LabImage seen_a = as_seen(opponent_a, pixels_per_degree), seen_b = as_seen(opponent_b, pixels_per_degree);
    const Features features_a = features(opponent_a[0], pixels_per_degree);
    const Features features_b = features(opponent_b[0], pixels_per_degree);
    std::vector<float> result(size_t{a.width} * a.height);
    parallel_for(result.size(), size_t{kRowsAtATime} * a.width, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const float change = std::max(std::abs(features_a.edges.values[i] - features_b.edges.values[i]),
                                          std::abs(features_a.points.values[i] - features_b.points.values[i]));
            const float feature_error = std::sqrt(std::min(1.0f, change / std::numbers::sqrt2_v<float>));
            const auto colour = [&](const LabImage& p) {
                return glm::vec3(p[0].values[i], p[1].values[i], p[2].values[i]);
            };
            result[i] = std::pow(colour_error(colour(seen_a), colour(seen_b)), 1 - feature_error);
        }
    });
    return result;
}

double mean_of(const std::vector<float>& errors) {
    double sum = 0;
    for (const float error : errors) sum += double{error};
    return sum / static_cast<double>(std::max<size_t>(errors.size(), 1));
}

media::Image flip_image(const std::vector<float>& errors, uint32_t width, uint32_t height) {
    assert(errors.size() == size_t{width} * height && "one value a pixel");
    constexpr size_t kLast = std::size(kMagma) - 1;
    media::Image image(width, height);
    for (size_t i = 0; i < errors.size(); ++i) {
        const float at = std::clamp(errors[i], 0.0f, 1.0f) * static_cast<float>(kLast);
        const size_t from = std::min(static_cast<size_t>(at), kLast - 1);
        const float share = at - static_cast<float>(from);
        for (size_t c = 0; c < 3; ++c)
            image.rgba[4 * i + c] = static_cast<uint8_t>(std::lround((1 - share) * static_cast<float>(kMagma[from][c]) +
                                                                     share * static_cast<float>(kMagma[from + 1][c])));
        image.rgba[4 * i + 3] = 255;
    }
    return image;
}

}  // namespace neuvv::training
