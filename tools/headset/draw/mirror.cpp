#include "tools/headset/draw/mirror.h"

#include <algorithm>

#include "render/clips/stage_renderer.h"
#include "render/set/raster.h"
#include "shared/mirror.h"
#include "spirv/eye.vert.h"
#include "spirv/mirror.frag.h"

namespace neuvv::headset {

namespace {

gpu::GraphicsShape mirror_shape() {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = eye_vert;
    shape.fragment_spirv = mirror_frag;
    shape.colours = {VK_FORMAT_R8G8B8A8_UNORM};
    shape.blend = false;
    shape.depth = VK_FORMAT_UNDEFINED;
    return shape;
}

// MirrorPush::panel_from_clip: the inverse of how points of the panel, as (u, v, 1), lie in the eye's clip space.
glm::mat4 panel_from_clip(const MirroredPanel& panel) {
    const glm::dmat4 world_from_panel = xr::matrix_of(panel.placement.world_from_panel);
    const glm::dvec2 size = panel.placement.size_m;
    const glm::dvec4 right = size.x * world_from_panel[0], down = -size.y * world_from_panel[1],
                     corner = world_from_panel[3] - 0.5 * (right + down);
    const glm::dmat4 clip = render::clip_from_world(panel.camera, render::kSetNear_m);
    glm::dmat3 clip_from_panel;
    const glm::dvec4 columns[] = {clip * right, clip * down, clip * corner};
    for (int i = 0; i < 3; ++i) clip_from_panel[i] = {columns[i].x, columns[i].y, columns[i].w};
    return glm::mat4(glm::dmat4(glm::inverse(clip_from_panel)));
}

// A panel is seen from its front alone.
bool shows_front(const MirroredPanel& panel) {
    const glm::dvec3 eye(panel.camera.world_from_camera[3]);
    return (xr::inverse(panel.placement.world_from_panel) * eye).z > 0;
}

}  // namespace

Mirror::Mirror(const gpu::Device& device, ui::Window& window, VkExtent2D eye, const gpu::DeviceImage& panel)
    : device_(device),
      window_(window),
      panel_(panel),
      swapchain_(device, window.make_surface(device), gpu::PresentPace::kFree),  // only the headset throttles the loop
      values_(device, "mirror",
              {eye.width, eye.height, VK_FORMAT_R8G8B8A8_UNORM,
               VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT}),
      pass_(device, "mirror", mirror_shape()),
      sampler_(device, "mirror",
               {VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_FILTER_LINEAR,
                VK_FILTER_LINEAR, false}),
      commands_(device, "mirror", 4) {
    swapchain_.resize(window.framebuffer());
}

Mirror::~Mirror() {
    device_.wait_idle_or_lost();
}

bool Mirror::show(const gpu::DeviceImage* image, const std::optional<MirroredPanel>& panel) {
    window_.poll();
    if (window_.close_requested()) return false;
    if (!image) return true;
    const VkExtent2D framebuffer = window_.framebuffer(), extent = swapchain_.extent();
    if (framebuffer.width == 0 || framebuffer.height == 0) return true;  // minimised
    if (!commands_.is_done()) return true;  // the monitor is slower than the headset: leave this image out
    commands_.wait();
    if (swapchain_.is_outdated() || framebuffer.width != extent.width || framebuffer.height != extent.height)
        swapchain_.resize(framebuffer);
    gpu::CommandSemaphores semaphores;
    const std::optional<gpu::PresentTarget> target = swapchain_.acquire(semaphores);
    if (!target) return true;
    commands_.begin();
    record(*image, panel, *target);
    commands_.submit(semaphores);
    swapchain_.present(*target);
    return true;
}

void Mirror::draw(const gpu::DeviceImage& image, const std::optional<MirroredPanel>& panel) {
    if (!bound_) {
        const std::pair<const gpu::DeviceImage*, const gpu::Sampler*> textures[] = {{&image, &sampler_},
                                                                                    {&panel_, &sampler_}};
        bound_.emplace(pass_, textures);
    }
    MirrorPush push{};
    push.has_panel = panel && shows_front(*panel);
    if (push.has_panel) push.panel_from_clip = panel_from_clip(*panel);
    VkRenderingAttachmentInfo colour{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    colour.imageView = values_.view;
    colour.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    colour.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea.extent = {values_.shape.width, values_.shape.height};
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colour;
    const VkCommandBuffer commands = commands_.handle();
    vkCmdBeginRendering(commands, &info);
    const VkViewport viewport{0, 0, static_cast<float>(values_.shape.width), static_cast<float>(values_.shape.height),
                              0, 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &info.renderArea);
    vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(commands, VK_FRONT_FACE_COUNTER_CLOCKWISE);
    vkCmdSetDepthWriteEnable(commands, VK_FALSE);
    const VkDescriptorSet set = bound_->handle();
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.pipeline());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.layout(), 0, 1, &set, 0, nullptr);
    vkCmdPushConstants(commands, pass_.layout(), gpu::kDrawStages, 0, pass_.interface().push_bytes, &push);
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRendering(commands);
}

void Mirror::record(const gpu::DeviceImage& image, const std::optional<MirroredPanel>& panel,
                    const gpu::PresentTarget& target) {
    constexpr VkImageLayout kRead = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                            kCopied = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                            kDrawn = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    gpu::move_layout(commands_, image, kCopied, kRead);
    gpu::move_layout(commands_, values_, VK_IMAGE_LAYOUT_UNDEFINED, kDrawn);
    draw(image, panel);
    gpu::move_layout(commands_, values_, kDrawn, kCopied);
    gpu::move_layout(commands_, image, kRead, kCopied);

    gpu::move_layout(commands_, target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkClearColorValue black{};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands_.handle(), target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1, &all);
    gpu::full_barrier(commands_);
    const double fits = std::min(static_cast<double>(target.extent.width) / values_.shape.width,
                                 static_cast<double>(target.extent.height) / values_.shape.height);
    const auto width = static_cast<int32_t>(values_.shape.width * fits),
               height = static_cast<int32_t>(values_.shape.height * fits);
    const VkOffset3D first{(static_cast<int32_t>(target.extent.width) - width) / 2,
                           (static_cast<int32_t>(target.extent.height) - height) / 2, 0};
    VkImageBlit blit{};
    blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    blit.srcOffsets[1] = {static_cast<int32_t>(values_.shape.width), static_cast<int32_t>(values_.shape.height), 1};
    blit.dstOffsets[0] = first;
    blit.dstOffsets[1] = {first.x + width, first.y + height, 1};
    vkCmdBlitImage(commands_.handle(), values_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.image,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
    gpu::move_layout(commands_, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}

}  // namespace neuvv::headset
