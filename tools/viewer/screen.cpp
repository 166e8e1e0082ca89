#include "tools/viewer/screen.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <backends/imgui_impl_glfw.h>

#include "tools/ui/theme.h"

namespace neuvv::viewer {

struct Screen::Frame {
    explicit Frame(const gpu::Device& device) : commands(device, "window", 4) {}
    gpu::Commands commands;
    std::shared_ptr<const gpu::DeviceImage> image;  // kept alive until its copy is done
};

namespace {

int32_t edge(int32_t offset, uint32_t extent) {
    return offset + static_cast<int32_t>(extent);
}

// The window may have become smaller since the image's area was computed.
bool is_in_window(const ScreenImage& image, VkExtent2D window) {
    return image.image && image.area.extent.width > 0 && image.area.extent.height > 0 && image.area.offset.x >= 0 &&
           image.area.offset.y >= 0 && image.area.offset.x < edge(0, window.width) &&
           image.area.offset.y < edge(0, window.height);
}

VkExtent2D visible_extent(const ScreenImage& image, VkExtent2D window) {
    return {std::min(image.area.extent.width, window.width - static_cast<uint32_t>(image.area.offset.x)),
            std::min(image.area.extent.height, window.height - static_cast<uint32_t>(image.area.offset.y))};
}

// extent · part / whole, at least 1.
uint32_t scaled(uint32_t extent, uint32_t part, uint32_t whole) {
    return std::max(1u, static_cast<uint32_t>(uint64_t{extent} * part / whole));
}

}  // namespace

Screen::Screen(const gpu::Device& device, ui::Window& window, float scale)
    : device_(device), window_(window), swapchain_(device, window.make_surface(device)) {
    for (auto& frame : frames_) frame = std::make_unique<Frame>(device);
    swapchain_.resize(window.framebuffer());
    drawing_ = std::make_unique<ui::PanelDrawing>(device, swapchain_.format(), swapchain_.image_count(), scale);
    make_framebuffers();
    ImGui_ImplGlfw_InitForVulkan(window_.handle(), false);  // the last, as nothing undoes it where more fails
}

Screen::~Screen() {
    device_.wait_idle_or_lost();
    ImGui_ImplGlfw_Shutdown();
    for (VkFramebuffer framebuffer : framebuffers_) vkDestroyFramebuffer(device_.handle(), framebuffer, nullptr);
}

void Screen::make_framebuffers() {
    for (VkFramebuffer framebuffer : framebuffers_) vkDestroyFramebuffer(device_.handle(), framebuffer, nullptr);
    framebuffers_.clear();
    for (uint32_t i = 0; i < swapchain_.image_count(); ++i)
        framebuffers_.push_back(ui::make_framebuffer(device_, *drawing_, swapchain_.view(i), swapchain_.extent()));
}

void Screen::begin() {
    drawing_->new_frame();
    ImGui_ImplGlfw_NewFrame();
    window_.feed_imgui();
    ImGui::NewFrame();
}

bool Screen::end(const ScreenImage& image) {
    ImGui::Render();
    const VkExtent2D framebuffer = window_.framebuffer();
    if (framebuffer.width == 0 || framebuffer.height == 0) return true;  // minimised
    const VkExtent2D extent = swapchain_.extent();
    if (swapchain_.is_outdated() || framebuffer.width != extent.width || framebuffer.height != extent.height) {
        swapchain_.resize(framebuffer);
        make_framebuffers();
    }
    Frame& frame = *frames_[next_frame_];
    frame.commands.wait();
    gpu::CommandSemaphores semaphores;
    const std::optional<gpu::PresentTarget> target = swapchain_.acquire(semaphores);
    if (!target) return false;
    if (capture_) capture_frame_ = next_frame_;
    next_frame_ = 1 - next_frame_;
    frame.image = image.image;
    frame.commands.begin();
    record(frame.commands, image, *target);
    frame.commands.submit(semaphores);
    swapchain_.present(*target);
    return true;
}

// Draws the image, scaled to its area, on a plain ground, and the panels over it.
void Screen::record(gpu::Commands& commands, const ScreenImage& image, const gpu::PresentTarget& target) {
    gpu::move_layout(commands, target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkClearColorValue ground = ui::background_colour();
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands.handle(), target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &ground, 1, &all);
    if (is_in_window(image, target.extent)) {
        gpu::full_barrier(commands);
        const VkExtent2D extent = visible_extent(image, target.extent);
        VkImageBlit blit{};
        blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        blit.srcOffsets[1] = {edge(0, scaled(image.size.width, extent.width, image.area.extent.width)),
                              edge(0, scaled(image.size.height, extent.height, image.area.extent.height)), 1};
        blit.dstOffsets[0] = {image.area.offset.x, image.area.offset.y, 0};
        blit.dstOffsets[1] = {edge(image.area.offset.x, extent.width), edge(image.area.offset.y, extent.height), 1};
        const bool same_size =
            image.size.width == image.area.extent.width && image.size.height == image.area.extent.height;
        vkCmdBlitImage(commands.handle(), image.image->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.image,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                       same_size ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
    }
    gpu::move_layout(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                     VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    drawing_->record(commands, framebuffers_[target.index], target.extent);
    VkImageLayout layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    if (capture_) {
        gpu::move_layout(commands, target.image, layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        record_capture(commands, target);
        layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    }
    gpu::move_layout(commands, target.image, layout, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}

void Screen::record_capture(gpu::Commands& commands, const gpu::PresentTarget& target) {
    capture_ = false;
    captured_size_ = target.extent;
    captured_ = gpu::Buffer(device_, "window capture", uint64_t{4} * target.extent.width * target.extent.height,
                            gpu::MemoryKind::kReadback);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {target.extent.width, target.extent.height, 1};
    vkCmdCopyImageToBuffer(commands.handle(), target.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, captured_.buffer, 1,
                           &region);
    gpu::host_barrier(commands);
}

std::optional<media::Image> Screen::take_capture() {
    if (!captured_.mapped) return std::nullopt;
    frames_[capture_frame_]->commands.wait();
    media::Image image(captured_size_.width, captured_size_.height);
    const uint8_t* source = captured_.as<uint8_t>();
    const bool swapped = swapchain_.format() == VK_FORMAT_B8G8R8A8_UNORM;
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        image.rgba[i] = source[i + (swapped ? 2 : 0)];
        image.rgba[i + 1] = source[i + 1];
        image.rgba[i + 2] = source[i + (swapped ? 0 : 2)];
        image.rgba[i + 3] = 255;
    }
    captured_ = gpu::Buffer();
    return image;
}

}  // namespace neuvv::viewer
