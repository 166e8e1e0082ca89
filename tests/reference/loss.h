// The training loss on one patch of pixels (L_rgb and L_grad, errata 10, 16), and the adjoint.
//
// Errors are taken between display values: P = srgb(C + (1−α) B) against I = srgb(C* + (1−α*) B), B the linear
// background.
//   L_rgb  = 1/M Σ_pixels Σ_channels (P−I)²
//   L_grad = 1/M Σ_pixels Σ_channels (e_right − e)² + (e_below − e)²,  e = |P−I|, neighbours inside the patch only
//   L      = L_rgb + λ L_grad,  M = pixels of the whole batch
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "reference/composite.h"

namespace neuvv::reference {

constexpr size_t kPatchSide = 8;
constexpr size_t kPatchPixels = kPatchSide * kPatchSide;

// The sRGB transfer function (IEC 61966-2-1) of max(linear, 0); above 1 its power law continues.
double display_value(double linear);
double display_slope(double linear);  // its derivative; from the right at 0

struct PatchPixel {
    glm::dvec3 colour{0};  // C, premultiplied linear
    double alpha = 0;
    glm::dvec3 true_colour{0};  // C*, premultiplied linear
    double true_alpha = 0;
    glm::dvec3 background{0};  // B, linear
    bool inside = true;        // false: beyond the image's edge; the pixel is ignored
};
using Patch = std::array<PatchPixel, kPatchPixels>;  // row-major

// Pixels from rays: the means of samples² neighbouring rays, which have the same target and background. The pixels are
// at the top left of the patch; the rest of it is not inside.
Patch pixel_means(const Patch& rays, size_t samples);

// The colour of a camera: it sees the foreground (C, α) as A C + α b.
struct CameraColour {
    glm::dmat3 matrix{1};  // A; glm's first index is the column
    glm::dvec3 offset{0};  // b
};
// The patch with its C as the camera sees it. C* is what the camera has seen, and stays.
Patch seen_by(const CameraColour& camera, Patch patch);

struct PatchLoss {
    double rgb = 0;
    double grad = 0;
    double total(double lambda_grad) const { return rgb + lambda_grad * grad; }
};
// This patch's share of the batch's loss.
PatchLoss patch_loss(const Patch& patch, double batch_pixels);

// Σ_i w_i α* |√c_i − √c*|² of one ray, where w_i are its samples' blending weights and c* = C*/α*; 0 where α* is 0. The
// samples end at the stop as in composite().
double point_loss(const std::vector<Sample>& samples, glm::dvec3 true_colour, double true_alpha,
                  double stop_transmittance = 0);

struct PixelGradient {
    glm::dvec3 colour{0};
    double alpha = 0;
};
// Derivatives of total() by each pixel's C and α. |·| has subgradient 0 at 0.
std::array<PixelGradient, kPatchPixels> patch_loss_adjoint(const Patch& patch, double lambda_grad, double batch_pixels);

// From the derivatives by C and α of seen_by(camera, patch): those by the patch's own, and those by A and b.
struct ColourGradient {
    std::array<PixelGradient, kPatchPixels> pixels;
    CameraColour camera{glm::dmat3(0), glm::dvec3(0)};
};
ColourGradient seen_by_adjoint(const CameraColour& camera, const Patch& patch,
                               const std::array<PixelGradient, kPatchPixels>& seen);

}  // namespace neuvv::reference
