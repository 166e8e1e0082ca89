#include "golden/flip.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <numbers>

namespace neuvv::test {
namespace {

constexpr double kPi = std::numbers::pi;
const glm::dvec3 kWhite{0.950428545, 1.0, 1.088900371};  // D65 in XYZ

struct Picture {
    int width, height;
    std::vector<glm::dvec3> pixels;
    // Beyond the edge the edge's pixel repeats.
    const glm::dvec3& at(int x, int y) const {
        return pixels[static_cast<size_t>(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1))];
    }
};

Picture map(const Picture& in, const std::function<glm::dvec3(glm::dvec3)>& f) {
    Picture out = in;
    for (glm::dvec3& pixel : out.pixels) pixel = f(pixel);
    return out;
}

Picture linear_picture(const Image& image) {
    Picture out{static_cast<int>(image.width), static_cast<int>(image.height), {}};
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        out.pixels.emplace_back(linear_from_srgb(image.rgba[i] / 255.0), linear_from_srgb(image.rgba[i + 1] / 255.0),
                                linear_from_srgb(image.rgba[i + 2] / 255.0));
    return out;
}

glm::dvec3 xyz_from_rgb(glm::dvec3 c) {
    return {(10135552.0 * c.r + 8788810.0 * c.g + 4435075.0 * c.b) / 24577794.0,
            (2613072.0 * c.r + 8788810.0 * c.g + 887015.0 * c.b) / 12288897.0,
            (1425312.0 * c.r + 8788810.0 * c.g + 70074185.0 * c.b) / 73733382.0};
}

glm::dvec3 rgb_from_xyz(glm::dvec3 c) {
    static const glm::dmat3 inverse =
        glm::inverse(glm::dmat3(xyz_from_rgb({1, 0, 0}), xyz_from_rgb({0, 1, 0}), xyz_from_rgb({0, 0, 1})));
    return inverse * c;
}

// YCxCz: linear in light, one channel of luminance and two of opponent colours.
glm::dvec3 opponent_from_rgb(glm::dvec3 rgb) {
    const glm::dvec3 c = xyz_from_rgb(rgb) / kWhite;
    return {116 * c.y - 16, 500 * (c.x - c.y), 200 * (c.y - c.z)};
}

glm::dvec3 rgb_from_opponent(glm::dvec3 c) {
    const double y = (c.x + 16) / 116;
    return rgb_from_xyz(glm::dvec3(c.y / 500 + y, y, y - c.z / 200) * kWhite);
}

// CIE L*a*b* with a* and b* damped in the dark (Hunt).
glm::dvec3 hunt_lab(glm::dvec3 rgb) {
    glm::dvec3 c = xyz_from_rgb(rgb) / kWhite;
    for (int i = 0; i < 3; i++) {
        const double delta = 6.0 / 29;
        c[i] = c[i] > delta * delta * delta ? std::cbrt(c[i]) : c[i] / (3 * delta * delta) + 4.0 / 29;
    }
    const double lightness = 116 * c.y - 16;
    return {lightness, 0.01 * lightness * 500 * (c.x - c.y), 0.01 * lightness * 200 * (c.y - c.z)};
}

double hyab(glm::dvec3 a, glm::dvec3 b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

using Kernel = std::vector<double>;  // odd length, centre in the middle

Picture separable(const Picture& in, const Kernel& along_x, const Kernel& along_y) {
    const int radius = static_cast<int>(along_x.size() / 2);
    const auto pass = [&](const Picture& from, const Kernel& kernel, int dx, int dy) {
        Picture to = from;
        for (int y = 0; y < from.height; y++)
            for (int x = 0; x < from.width; x++) {
                glm::dvec3 sum(0);
                for (int i = -radius; i <= radius; i++)
                    sum += kernel[static_cast<size_t>(i + radius)] * from.at(x + i * dx, y + i * dy);
                to.pixels[static_cast<size_t>(y * from.width + x)] = sum;
            }
        return to;
    };
    return pass(pass(in, along_x, 1, 0), along_y, 0, 1);
}

Kernel kernel_of(int radius, const std::function<double(double)>& f) {
    Kernel kernel;
    for (int i = -radius; i <= radius; i++) kernel.push_back(f(i));
    return kernel;
}

// One term a·sqrt(π/b)·exp(−π² d²/b) of a contrast sensitivity function, d in degrees.
struct SensitivityTerm {
    double a, b;
};
struct Sensitivity {
    int channel;
    std::vector<SensitivityTerm> terms;
};

// What is left of a picture at this viewing distance: each channel blurred by its contrast sensitivity.
Picture seen(const Picture& rgb, double pixels_per_degree) {
    const Sensitivity sensitivities[] = {{0, {{1, 0.0047}}}, {1, {{1, 0.0053}}}, {2, {{34.1, 0.04}, {13.5, 0.025}}}};
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * pixels_per_degree));
    const Picture opponent = map(rgb, opponent_from_rgb);
    Picture blurred = map(rgb, [](glm::dvec3) { return glm::dvec3(0); });
    for (const auto& [channel, terms] : sensitivities) {
        double whole = 0;
        for (const auto& [a, b] : terms) {
            const Kernel kernel = kernel_of(radius, [&, b = b](double x) {
                return std::exp(-kPi * kPi * x * x / (pixels_per_degree * pixels_per_degree * b));
            });
            double sum = 0;
            for (const double value : kernel) sum += value;
            const double height = a * std::sqrt(kPi / b);
            whole += height * sum * sum;
            const Picture part = separable(opponent, kernel, kernel);
            for (size_t i = 0; i < part.pixels.size(); i++)
                blurred.pixels[i][channel] += height * part.pixels[i][channel];
        }
        for (glm::dvec3& pixel : blurred.pixels) pixel[channel] /= whole;
    }
    return map(blurred, [](glm::dvec3 c) { return hunt_lab(glm::clamp(rgb_from_opponent(c), 0.0, 1.0)); });
}

// Its positive values sum to 1, its negative ones to −1 (or to 0).
Kernel normalised(Kernel kernel) {
    double positive = 0, negative = 0;
    for (const double value : kernel) (value > 0 ? positive : negative) += value;
    for (double& value : kernel) value /= value > 0 ? positive : -negative;
    return kernel;
}

// Strength of edges (x) and of points (y) in the luminance.
Picture features(const Picture& rgb, double pixels_per_degree) {
    const double deviation = 0.5 * 0.082 * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto bell = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
    const Kernel smooth = normalised(kernel_of(radius, bell));
    const Kernel edge = normalised(kernel_of(radius, [&](double x) { return -x * bell(x); }));
    const Kernel point =
        normalised(kernel_of(radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * bell(x); }));
    const Picture grey = map(rgb, [](glm::dvec3 c) { return glm::dvec3((opponent_from_rgb(c).x + 16) / 116); });
    const Picture edge_x = separable(grey, edge, smooth), edge_y = separable(grey, smooth, edge);
    const Picture point_x = separable(grey, point, smooth), point_y = separable(grey, smooth, point);
    Picture out = grey;
    for (size_t i = 0; i < out.pixels.size(); i++)
        out.pixels[i] = {std::hypot(edge_x.pixels[i].x, edge_y.pixels[i].x),
                         std::hypot(point_x.pixels[i].x, point_y.pixels[i].x), 0};
    return out;
}

// Large colour differences are compressed into the top twentieth of [0,1].
double colour_error(glm::dvec3 a, glm::dvec3 b) {
    constexpr double kExponent = 0.7, kKnee = 0.4, kAtKnee = 0.95;
    static const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kExponent);
    const double error = std::pow(hyab(a, b), kExponent), knee = kKnee * largest;
    return error < knee ? error * kAtKnee / knee
                        : std::min(1.0, kAtKnee + (error - knee) / (largest - knee) * (1 - kAtKnee));
}

}  // namespace

std::vector<double> flip(const Image& a, const Image& b, double pixels_per_degree) {
    const Picture rgb_a = linear_picture(a), rgb_b = linear_picture(b);
    const Picture seen_a = seen(rgb_a, pixels_per_degree), seen_b = seen(rgb_b, pixels_per_degree);
    const Picture features_a = features(rgb_a, pixels_per_degree), features_b = features(rgb_b, pixels_per_degree);
    std::vector<double> result;
    for (size_t i = 0; i < rgb_a.pixels.size(); i++) {
        const glm::dvec3 change = glm::abs(features_a.pixels[i] - features_b.pixels[i]);
        const double feature_error = std::sqrt(std::min(1.0, std::max(change.x, change.y) / std::numbers::sqrt2));
        result.push_back(std::pow(colour_error(seen_a.pixels[i], seen_b.pixels[i]), 1 - feature_error));
    }
    return result;
}

}  // namespace neuvv::test
