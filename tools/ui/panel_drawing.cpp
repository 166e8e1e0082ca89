#include "tools/ui/panel_drawing.h"

#include <imgui.h>

#include <algorithm>

#include <backends/imgui_impl_vulkan.h>

#include "tools/ui/theme.h"

namespace neuvv::ui {

namespace {

void check_imgui(VkResult result) {
    if (result < 0) gpu::check(result, "Vulkan", "panels");
}

}  // namespace

PanelDrawing::PanelDrawing(const gpu::Device& device, VkFormat format, uint32_t images, float scale)
    : device_(device), format_(format), images_(images), scale_(scale) {
    make_render_pass();
    constexpr VkDescriptorPoolSize kSize{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
    pool.maxSets = 4;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &kSize;
    gpu::check(vkCreateDescriptorPool(device_.handle(), &pool, nullptr, &descriptors_), "vkCreateDescriptorPool",
               "panels");
    ImGui::CreateContext();
    ImGui::GetIO().ConfigDragClickToInputText = true;
    ImGui::GetIO().IniFilename = nullptr;  // the viewer's preferences keep the layout instead
    try {
        start_backend();
    } catch (...) {  // the device is lost: there may be another one, with a context of its own
        end();
        throw;
    }
}

PanelDrawing::~PanelDrawing() {
    end();
}

void PanelDrawing::end() {
    device_.wait_idle_or_lost();
    ImGui_ImplVulkan_Shutdown();
    ImGui::DestroyContext();
    vkDestroyRenderPass(device_.handle(), render_pass_, nullptr);
    vkDestroyDescriptorPool(device_.handle(), descriptors_, nullptr);
}

// ImGui's Vulkan backend does not support dynamic rendering.
void PanelDrawing::make_render_pass() {
    VkAttachmentDescription colour{};
    colour.format = format_;
    colour.samples = VK_SAMPLE_COUNT_1_BIT;
    colour.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    colour.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    colour.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    colour.initialLayout = colour.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &reference;
    VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
    info.attachmentCount = 1;
    info.pAttachments = &colour;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    gpu::check(vkCreateRenderPass(device_.handle(), &info, nullptr, &render_pass_), "vkCreateRenderPass", "panels");
}

void PanelDrawing::start_backend() {
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = device_.instance();
    info.PhysicalDevice = device_.physical();
    info.Device = device_.handle();
    info.QueueFamily = device_.queue_family();
    info.Queue = device_.queue();
    info.PipelineCache = device_.pipeline_cache();
    info.DescriptorPool = descriptors_;
    info.MinImageCount = 2;
    info.ImageCount = std::max<uint32_t>(2, images_) + 1;  // the backend has as many vertex buffers, used in turn
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    info.CheckVkResultFn = check_imgui;
    ImGui_ImplVulkan_Init(&info, render_pass_);
    make_fonts();
}

void PanelDrawing::make_fonts() {
    apply_theme(scale_);
    gpu::run_once(device_, "fonts",
                  [](gpu::Commands& commands) { ImGui_ImplVulkan_CreateFontsTexture(commands.handle()); });
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}

// The backend frees the font texture only together with everything else.
void PanelDrawing::set_scale(float scale) {
    if (scale == scale_) return;
    scale_ = scale;
    device_.wait_idle();
    ImGui_ImplVulkan_Shutdown();
    start_backend();
}

void PanelDrawing::new_frame() {
    ImGui_ImplVulkan_NewFrame();
}

void PanelDrawing::record(gpu::Commands& commands, VkFramebuffer framebuffer, VkExtent2D extent) {
    VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    begin.renderPass = render_pass_;
    begin.framebuffer = framebuffer;
    begin.renderArea.extent = extent;
    vkCmdBeginRenderPass(commands.handle(), &begin, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands.handle());
    vkCmdEndRenderPass(commands.handle());
}

VkFramebuffer make_framebuffer(const gpu::Device& device, const PanelDrawing& drawing, VkImageView view,
                               VkExtent2D extent) {
    VkFramebufferCreateInfo info{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    info.renderPass = drawing.render_pass();
    info.attachmentCount = 1;
    info.pAttachments = &view;
    info.width = extent.width;
    info.height = extent.height;
    info.layers = 1;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    gpu::check(vkCreateFramebuffer(device.handle(), &info, nullptr, &framebuffer), "vkCreateFramebuffer", "panels");
    return framebuffer;
}

}  // namespace neuvv::ui
