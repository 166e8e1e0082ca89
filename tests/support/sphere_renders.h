// Renders of a model that was trained on a sphere's capture, by cameras that the capture does not have.
#pragma once

#include "media/psnr.h"
#include "render/frame/frame_renderer.h"
#include "support/sphere_capture.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {

// The capture on which the tests of whole runs train, and its images.
inline const SphereCapture kTrainedSphere;

inline training::Dataset& trained_sphere() {
    static training::Dataset dataset = sphere_dataset(kTrainedSphere);
    return dataset;
}

inline media::Image over_white(const media::Image& image) {
    const uint8_t white[3] = {255, 255, 255};
    return media::composite_over(image, white);
}

// Renders of a field in every frame, by cameras between those of the capture.
inline std::vector<media::Image> held_out_renders(const gpu::Device& device, const SphereCapture& capture,
                                                  const render::Field& field) {
    SphereCapture between = capture;
    between.first_angle += std::numbers::pi / capture.cameras;
    render::FrameRenderer renderer(device, field, {capture.size, capture.size});
    std::vector<media::Image> renders;
    for (const uint32_t camera : {1u, 6u})
        for (uint32_t frame = 0; frame < capture.frames; ++frame)
            renders.push_back(renderer.render(
                sphere_camera(between, camera),
                {.instances = {{static_cast<float>(frame)}}, .width = capture.size, .height = capture.size}));
    return renders;
}

inline std::vector<media::Image> held_out_renders(const gpu::Device& device, const SphereCapture& capture,
                                                  const std::filesystem::path& nvv) {
    return held_out_renders(device, capture,
                            render::upload_field(device, voctree::read_nvv(nvv), render::WeightPrecision::kHalf));
}

inline std::vector<media::Image> held_out_truths(const SphereCapture& capture) {
    SphereCapture between = capture;
    between.first_angle += std::numbers::pi / capture.cameras;
    std::vector<media::Image> truths;
    for (const uint32_t camera : {1u, 6u})
        for (uint32_t frame = 0; frame < capture.frames; ++frame)
            truths.push_back(sphere_image(capture, sphere_camera(between, camera), capture.time(frame)));
    return truths;
}

inline double mean_psnr(const std::vector<media::Image>& truths, const std::vector<media::Image>& renders) {
    double sum = 0;
    for (size_t i = 0; i < truths.size(); ++i) sum += media::psnr_db(over_white(truths[i]), over_white(renders[i]));
    return sum / static_cast<double>(truths.size());
}

}  // namespace neuvv::test
