// The images of a window: acquired, drawn into, presented.
#pragma once

#include <optional>

#include "gpu/commands.h"

namespace neuvv::gpu {

// The device extensions that presenting needs. The window system names the instance extensions that it needs.
inline const std::vector<const char*> kPresentExtensions{VK_KHR_SWAPCHAIN_EXTENSION_NAME};

// An acquired image of the window, to be drawn to and presented.
struct PresentTarget {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    uint32_t index = 0;
    VkExtent2D extent{};
};

// What presenting waits for.
enum class PresentPace {
    // The display: each image is shown for at least one period of it, and acquire() waits until an image is free.
    kDisplay,
    // Nothing: the newest image is shown, and acquire() returns no image where none is free. Where the system has no
    // such mode, an image may be acquired while it is still shown; drawing to it then waits on the device.
    kFree,
};

// Images of 8-bit colour, which hold sRGB values in a UNORM format; they may be drawn to and copied to. Only one thread
// may use it.
class Swapchain {
  public:
    // Takes ownership of the surface. Throws RuntimeFailure where the device cannot present to it, where images cannot
    // be copied to it, or where it offers no 8-bit sRGB format.
    Swapchain(const Device& device, VkSurfaceKHR surface, PresentPace pace = PresentPace::kDisplay);
    ~Swapchain();
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    VkFormat format() const { return format_; }
    uint32_t image_count() const { return static_cast<uint32_t>(images_.size()); }
    VkExtent2D extent() const { return extent_; }
    VkImageView view(uint32_t index) const { return views_[index]; }

    // Creates the images for a framebuffer of this size, after waiting for the device. A framebuffer without pixels (a
    // minimised window) has no images.
    void resize(VkExtent2D framebuffer);

    // Returns the next image and sets the semaphores that drawing to it must wait for and signal. Returns nothing where
    // the window's size has changed (is_outdated) or is 0, or where no image was free: within 20 ms at the display's
    // pace, at once at a free pace.
    std::optional<PresentTarget> acquire(CommandSemaphores& semaphores);
    // Shows the image. The commands that draw to it must have been submitted.
    void present(const PresentTarget& target);
    // Whether the images no longer fit the window: then resize() is due.
    bool is_outdated() const { return outdated_; }

  private:
    void choose_format();
    void choose_mode();
    void destroy_images();
    void make_semaphores();
    const Device& device_;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    PresentPace pace_;
    VkPresentModeKHR mode_ = VK_PRESENT_MODE_FIFO_KHR;  // the only mode that every device has
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    VkExtent2D extent_{};
    std::vector<VkImage> images_;
    std::vector<VkImageView> views_;
    std::vector<VkSemaphore> acquired_;  // used in turn; one more than images
    std::vector<VkSemaphore> drawn_;     // by image
    size_t next_acquired_ = 0;
    bool outdated_ = true;
};

}  // namespace neuvv::gpu
