#include "render/set/set_targets.h"

#include <array>
#include <cmath>
#include <string>

#include "render/set/set_attachments.h"

namespace neuvv::render {

namespace {

constexpr uint32_t kInfinityBits = 0x7f800000u;

VkRect2D area_of(const stage::Camera& camera) {
    return {{0, 0}, {camera.width, camera.height}};
}

void make_images(const gpu::Device& device, SetTargets& targets) {
    constexpr VkImageUsageFlags kColourUse = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    for (uint32_t view = 0; view < targets.views(); ++view) {
        const std::string of_view = " " + std::to_string(view);
        targets.colour_images[view] =
            gpu::DeviceImage(device, "set colour" + of_view, {targets.width, targets.height, kSetColour, kColourUse});
        targets.depth_images[view] = gpu::DeviceImage(
            device, "set depth" + of_view,
            {targets.width, targets.height, VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT});
    }
    targets.metres_image =
        gpu::DeviceImage(device, "set metres", {targets.width, targets.height, kSetMetres, kColourUse});
    targets.front_image =
        gpu::DeviceImage(device, "set front", {targets.width, targets.height, kSetColour, kColourUse});
}

}  // namespace

SetTargets::SetTargets(const gpu::Device& device, uint32_t given_width, uint32_t given_height, uint32_t views)
    : width(given_width), height(given_height), colour_images(views), depth_images(views) {
    resize(device, width, height);
}

void SetTargets::resize(const gpu::Device& device, uint32_t new_width, uint32_t new_height) {
    const uint32_t views = this->views();
    width = new_width;
    height = new_height;
    const uint64_t texels = uint64_t{views} * width * height;
    colour = gpu::Buffer(device, "set colour", 8 * texels, gpu::MemoryKind::kDevice, kSetColour);
    front = gpu::Buffer(device, "set front", 8 * texels, gpu::MemoryKind::kDevice, kSetColour);
    depth = gpu::Buffer(device, "set depth", 4 * texels, gpu::MemoryKind::kDevice, kSetMetres);
    volume_depth = gpu::Buffer(device, "set volume depth", 4 * texels, gpu::MemoryKind::kDevice, kSetMetres);
    make_images(device, *this);
    gpu::run_once(device, "set buffers", [&](gpu::Commands& commands) {
        for (const gpu::Buffer* nothing : {&colour, &front}) gpu::fill(commands, *nothing, 0);
        for (const gpu::Buffer* far : {&depth, &volume_depth}) gpu::fill(commands, *far, kInfinityBits);
    });
}

void begin_solid(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view) {
    const gpu::DeviceImage &colour = targets.colour_images[view], &depth = targets.depth_images[view];
    for (const gpu::DeviceImage* image : {&colour, &targets.metres_image, &depth}) to_attachment(commands, *image);
    const std::array drawn{colour_attachment(colour, false), colour_attachment(targets.metres_image, false, INFINITY)};
    begin_drawing(commands, drawn, depth_attachment(depth, false), area_of(camera));
}

void end_solid(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view) {
    vkCmdEndRendering(commands.handle());
    store(commands, targets.colour_images[view], area_of(camera), targets.colour, view);
    store(commands, targets.metres_image, area_of(camera), targets.depth, view);
}

void begin_blended(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view) {
    const gpu::DeviceImage &colour = targets.colour_images[view], &depth = targets.depth_images[view];
    to_attachment(commands, colour, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    to_attachment(commands, targets.front_image);
    to_attachment(commands, depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    const std::array drawn{colour_attachment(colour, true), colour_attachment(targets.front_image, false)};
    begin_drawing(commands, drawn, depth_attachment(depth, true), area_of(camera));
}

void end_blended(gpu::Commands& commands, const SetTargets& targets, const stage::Camera& camera, uint32_t view) {
    vkCmdEndRendering(commands.handle());
    store(commands, targets.colour_images[view], area_of(camera), targets.colour, view);
    store(commands, targets.front_image, area_of(camera), targets.front, view);
}

}  // namespace neuvv::render
