// The images of a window: acquired, drawn into, presented.
#pragma once

#include <optional>

#include "gpu/commands.h"

namespace neuvv::gpu {

// Extensions of the device that presenting needs, beyond those of the instance that the window system names.
inline const std::vector<const char*> kPresentExtensions{VK_KHR_SWAPCHAIN_EXTENSION_NAME};

// One of the window's images, while it is drawn into.
struct PresentTarget {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    uint32_t index = 0;
    VkExtent2D extent{};
};

// What presenting waits for.
enum class PresentPace {
    kDisplay,  // each image is shown for a period at least; acquire() waits for an image
    kFree,     // nothing: the newest image is shown, and where there is no image it is left out. Where the system knows
            // the display's pace alone, an image may come before it is free: what is drawn into it waits on the device
};

// 8-bit colour as it is on the screen (UNORM, sRGB values), to be copied to and drawn to. One thread's.
class Swapchain {
  public:
    // Takes the surface. Throws RuntimeFailure where the device cannot present to it, or not as needed.
    Swapchain(const Device& device, VkSurfaceKHR surface, PresentPace pace = PresentPace::kDisplay);
    ~Swapchain();
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    VkFormat format() const { return format_; }
    uint32_t image_count() const { return static_cast<uint32_t>(images_.size()); }
    VkExtent2D extent() const { return extent_; }
    VkImageView view(uint32_t index) const { return views_[index]; }

    // For a framebuffer of so many pixels; waits until the device has finished with the images before. Without pixels
    // (a minimised window) there are no images.
    void resize(VkExtent2D framebuffer);

    // The next image, and the semaphores that its drawing waits for and signals; none where the window has another size
    // by now (is_outdated), no size, or nothing came: within 20 ms by the display's pace, at once by a free one.
    std::optional<PresentTarget> acquire(CommandSemaphores& semaphores);
    // After its drawing was submitted.
    void present(const PresentTarget& target);
    // The window has another size by now: resize().
    bool is_outdated() const { return outdated_; }

  private:
    void choose_format();
    void choose_mode();
    void destroy_images();
    void make_semaphores();
    const Device& device_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    PresentPace pace_;
    VkPresentModeKHR mode_ = VK_PRESENT_MODE_FIFO_KHR;  // the only one that every device has
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    VkExtent2D extent_{};
    std::vector<VkImage> images_;
    std::vector<VkImageView> views_;
    std::vector<VkSemaphore> acquired_;  // in turn, one more than images
    std::vector<VkSemaphore> drawn_;     // by image
    size_t next_acquired_ = 0;
    bool outdated_ = true;
};

}  // namespace neuvv::gpu
