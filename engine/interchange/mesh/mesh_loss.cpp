#include "interchange/mesh/mesh_loss.h"

#include <algorithm>
#include <cmath>

namespace neuvv::interchange {

namespace {

constexpr uint32_t kSamples = 2;  // rays a pixel along each side, as the clip's images have
constexpr float kCovered = 0.5f;
constexpr double kMostPsnr_db = 99;

double on_white(const media::LinearImage& image, size_t pixel, size_t channel) {
    const float linear = image.rgba[4 * pixel + channel] + 1 - image.rgba[4 * pixel + 3];
    return media::srgb_from_linear(std::clamp(double{linear}, 0.0, 1.0));
}

}  // namespace

MeshLoss loss_of(const ColouredMesh& mesh, std::span<const MeshView> views) {
    size_t both = 0, either = 0, numbers = 0;
    double squares = 0, depths = 0;
    std::vector<float> differences;
    for (const MeshView& view : views) {
        const media::LinearImage drawn = mesh_image(mesh, view.camera, kSamples);
        for (size_t i = 0; i < drawn.depth_m.size(); ++i) {
            const bool is = drawn.rgba[4 * i + 3] >= kCovered, was = view.image.rgba[4 * i + 3] >= kCovered;
            either += is || was ? 1 : 0;
            both += is && was ? 1 : 0;
            if (is && was) differences.push_back(std::abs(drawn.depth_m[i] - view.image.depth_m[i]));
            for (size_t c = 0; c < 3; ++c) {
                const double difference = on_white(drawn, i, c) - on_white(view.image, i, c);
                squares += difference * difference;
                ++numbers;
            }
        }
    }
    MeshLoss loss;
    if (either > 0) loss.iou = static_cast<double>(both) / static_cast<double>(either);
    if (!differences.empty()) {
        for (const float difference : differences) depths += double{difference};
        loss.depth_mean_mm = 1000 * depths / static_cast<double>(differences.size());
        const auto at =
            differences.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(differences.size()));
        std::nth_element(differences.begin(), at, differences.end());
        loss.depth_95_mm = 1000 * double{*at};
    }
    loss.psnr_db =
        squares > 0 ? std::min(-10 * std::log10(squares / static_cast<double>(numbers)), kMostPsnr_db) : kMostPsnr_db;
    return loss;
}

}  // namespace neuvv::interchange
