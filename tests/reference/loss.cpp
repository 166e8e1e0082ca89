#include "reference/loss.h"

#include <algorithm>
#include <cmath>

namespace neuvv::reference {
namespace {

constexpr double kLinearEnd = 0.0031308;

glm::dvec3 display(glm::dvec3 linear) {
    return {display_value(linear.x), display_value(linear.y), display_value(linear.z)};
}

glm::dvec3 over_background(glm::dvec3 colour, double alpha, glm::dvec3 background) {
    return colour + (1 - alpha) * background;
}

// P − I of each pixel; 0 beyond the image's edge.
std::array<glm::dvec3, kPatchPixels> differences(const Patch& patch) {
    std::array<glm::dvec3, kPatchPixels> result{};
    for (size_t i = 0; i < kPatchPixels; ++i) {
        const PatchPixel& p = patch[i];
        if (!p.inside) continue;
        result[i] = display(over_background(p.colour, p.alpha, p.background)) -
                    display(over_background(p.true_colour, p.true_alpha, p.background));
    }
    return result;
}

// Calls visit(pixel, neighbour) for each forward difference inside the patch and the image.
template <typename Visit>
void each_neighbour(const Patch& patch, const Visit& visit_pair) {
    const auto visit = [&](size_t pixel, size_t neighbour) {
        if (patch[pixel].inside && patch[neighbour].inside) visit_pair(pixel, neighbour);
    };
    for (size_t y = 0; y < kPatchSide; ++y) {
        for (size_t x = 0; x < kPatchSide; ++x) {
            const size_t i = y * kPatchSide + x;
            if (x + 1 < kPatchSide) visit(i, i + 1);
            if (y + 1 < kPatchSide) visit(i, i + kPatchSide);
        }
    }
}

}  // namespace

double display_value(double linear) {
    const double x = std::max(linear, 0.0);
    return x <= kLinearEnd ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

double display_slope(double linear) {
    if (linear < 0) return 0;
    return linear <= kLinearEnd ? 12.92 : 1.055 / 2.4 * std::pow(linear, 1 / 2.4 - 1);
}

Patch pixel_means(const Patch& rays, size_t samples) {
    Patch pixels;
    for (PatchPixel& pixel : pixels) pixel.inside = false;
    const double share = 1.0 / static_cast<double>(samples * samples);
    for (size_t y = 0; y < kPatchSide; ++y)
        for (size_t x = 0; x < kPatchSide; ++x) {
            const PatchPixel& ray = rays[y * kPatchSide + x];
            PatchPixel& pixel = pixels[y / samples * kPatchSide + x / samples];
            const PatchPixel so_far = pixel;
            pixel = ray;
            pixel.colour = so_far.colour + share * ray.colour;
            pixel.alpha = so_far.alpha + share * ray.alpha;
        }
    return pixels;
}

Patch seen_by(const CameraColour& camera, Patch patch) {
    for (PatchPixel& p : patch) p.colour = camera.matrix * p.colour + p.alpha * camera.offset;
    return patch;
}

PatchLoss patch_loss(const Patch& patch, double batch_pixels) {
    const auto difference = differences(patch);
    PatchLoss loss;
    for (const glm::dvec3& d : difference) loss.rgb += glm::dot(d, d);
    each_neighbour(patch, [&](size_t pixel, size_t neighbour) {
        const glm::dvec3 step = glm::abs(difference[neighbour]) - glm::abs(difference[pixel]);
        loss.grad += glm::dot(step, step);
    });
    loss.rgb /= batch_pixels;
    loss.grad /= batch_pixels;
    return loss;
}

double point_loss(const std::vector<Sample>& samples, glm::dvec3 true_colour, double true_alpha,
                  double stop_transmittance) {
    if (true_alpha <= 0) return 0;
    const glm::dvec3 root = glm::sqrt(true_colour / true_alpha);
    double sum = 0, transmittance = 1;
    for (const Sample& sample : samples) {
        const double behind = transmittance * std::exp(-sample.sigma * sample.delta_m);
        const glm::dvec3 wrong = glm::sqrt(sample.colour) - root;
        sum += (transmittance - behind) * true_alpha * glm::dot(wrong, wrong);
        transmittance = behind;
        if (transmittance < stop_transmittance) break;
    }
    return sum;
}

std::array<PixelGradient, kPatchPixels> patch_loss_adjoint(const Patch& patch, double lambda_grad,
                                                           double batch_pixels) {
    const auto difference = differences(patch);
    std::array<glm::dvec3, kPatchPixels> d_error{};  // ∂L/∂e, e = |P−I|
    each_neighbour(patch, [&](size_t pixel, size_t neighbour) {
        const glm::dvec3 step = glm::abs(difference[neighbour]) - glm::abs(difference[pixel]);
        d_error[neighbour] += 2.0 * lambda_grad / batch_pixels * step;
        d_error[pixel] -= 2.0 * lambda_grad / batch_pixels * step;
    });
    std::array<PixelGradient, kPatchPixels> gradient{};
    for (size_t i = 0; i < kPatchPixels; ++i) {
        const PatchPixel& p = patch[i];
        const glm::dvec3 linear = over_background(p.colour, p.alpha, p.background);
        const glm::dvec3 slope{display_slope(linear.x), display_slope(linear.y), display_slope(linear.z)};
        // glm::sign(0) is 0: the subgradient of |·|.
        const glm::dvec3 d_display = 2.0 / batch_pixels * difference[i] + glm::sign(difference[i]) * d_error[i];
        gradient[i].colour = d_display * slope;
        gradient[i].alpha = -glm::dot(gradient[i].colour, p.background);
    }
    return gradient;
}

ColourGradient seen_by_adjoint(const CameraColour& camera, const Patch& patch,
                               const std::array<PixelGradient, kPatchPixels>& seen) {
    ColourGradient gradient{seen};
    for (size_t i = 0; i < kPatchPixels; ++i) {
        const glm::dvec3 d = seen[i].colour;
        gradient.pixels[i].colour = glm::transpose(camera.matrix) * d;
        gradient.pixels[i].alpha = seen[i].alpha + glm::dot(camera.offset, d);
        gradient.camera.matrix += glm::outerProduct(d, patch[i].colour);
        gradient.camera.offset += patch[i].alpha * d;
    }
    return gradient;
}

}  // namespace neuvv::reference
