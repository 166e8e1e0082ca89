#include "tools/headset/panel/panel_surface.h"

#include <imgui.h>

#include <cfloat>

namespace neuvv::headset {

namespace {

constexpr VkExtent2D kSize{kPanelWidth, kPanelHeight};

xr::SwapchainShape shape() {
    xr::SwapchainShape shape{kSize, 1, XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT};
    shape.formats = {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB};
    return shape;
}

VkFormat unorm_of(VkFormat srgb) {
    return srgb == VK_FORMAT_B8G8R8A8_SRGB ? VK_FORMAT_B8G8R8A8_UNORM : VK_FORMAT_R8G8B8A8_UNORM;
}

}  // namespace

PanelSurface::PanelSurface(const gpu::Device& device, const xr::Session& session)
    : device_(device),
      images_(session, device, "panel", shape()),
      imgui_image_(device, "panel",
                   {kSize.width, kSize.height, unorm_of(images_.format()),
                    VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                        VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT}),
      drawing_(device, imgui_image_.shape.format, 2, kPanelScale),
      framebuffer_(ui::make_framebuffer(device, drawing_, imgui_image_.view, kSize)),
      commands_(device, "panel", 4) {
    gpu::run_once(device, "panel", [&](gpu::Commands& commands) {
        gpu::move_layout(commands, imgui_image_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    });
}

PanelSurface::~PanelSurface() {
    device_.wait_idle_or_lost();
    vkDestroyFramebuffer(device_.handle(), framebuffer_, nullptr);
}

void PanelSurface::update_input(const PanelPointer& pointer, double dt_s) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(kSize.width), static_cast<float>(kSize.height)};
    io.DeltaTime = static_cast<float>(std::max(dt_s, 1e-3));
    io.MousePos = pointer.uv ? ImVec2{static_cast<float>(pointer.uv->x) * io.DisplaySize.x,
                                      static_cast<float>(pointer.uv->y) * io.DisplaySize.y}
                             : ImVec2{-FLT_MAX, -FLT_MAX};
    io.MouseDown[0] = pointer.pressed;
    io.MouseWheel = static_cast<float>(pointer.wheel * 6 * dt_s);
}

void PanelSurface::draw(const PanelPointer& pointer, double dt_s, const std::function<void()>& draw_widgets) {
    update_input(pointer, dt_s);
    drawing_.new_frame();
    ImGui::NewFrame();
    draw_widgets();
    ImGui::Render();
    const uint32_t index = images_.acquire();
    commands_.wait();  // for the last image
    commands_.begin();
    record(images_.image(index));
    commands_.submit();
    images_.release();
    has_image_ = true;
}

void PanelSurface::record(VkImage to) {
    constexpr VkImageSubresourceRange kAll{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    gpu::move_layout(commands_, imgui_image_, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkClearColorValue clear{};
    vkCmdClearColorImage(commands_.handle(), imgui_image_.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &clear, 1,
                         &kAll);
    gpu::move_layout(commands_, imgui_image_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                     VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    drawing_.record(commands_, framebuffer_, kSize);
    gpu::move_layout(commands_, imgui_image_, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    gpu::move_layout(commands_, to, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    VkImageCopy part{};
    part.srcSubresource = part.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    part.extent = {kSize.width, kSize.height, 1};
    vkCmdCopyImage(commands_.handle(), imgui_image_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &part);
    gpu::move_layout(commands_, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    gpu::move_layout(commands_, imgui_image_, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                     VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

const XrCompositionLayerBaseHeader* PanelSurface::layer(const xr::Session& session, const xr::Pose& tracking_from_panel,
                                                        glm::dvec2 size_m) {
    quad_.layerFlags = 0;  // opaque: the room's layer, which may lie beneath it, does not shine through
    quad_.space = session.tracking_space();
    quad_.eyeVisibility = XR_EYE_VISIBILITY_BOTH;
    quad_.subImage = images_.sub_image(0);
    quad_.pose = xr::xr_pose(tracking_from_panel);
    quad_.size = {static_cast<float>(size_m.x), static_cast<float>(size_m.y)};
    return reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad_);
}

}  // namespace neuvv::headset
