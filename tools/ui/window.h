// The window and what hands do to it. Events wait in a queue and reach a frame in such portions that no short press is
// lost, however long frames take.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "gpu/swapchain.h"
#include "tools/ui/window_geometry.h"

struct GLFWwindow;

namespace neuvv::ui {

// A key that went down, or repeats; `key` is GLFW's by what is printed on it where that is a letter, `place` by where
// it lies on a keyboard.
struct KeyPress {
    int key = 0, place = 0;
    bool control = false, shift = false, alt = false, repeat = false;
};

// What has reached frames so far, for programs that drive the window and want to know.
struct HandledInput {
    double x = 0, y = 0;                 // of the pointer
    uint64_t releases = 0, scrolls = 0;  // of keys and buttons; notches
};

class Window {
  public:
    // Throws RuntimeFailure in one line where there is no display.
    Window(const std::string& title, const WindowGeometry& place);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    gpu::DeviceExtensions extensions() const;  // for a device that can present to it
    VkSurfaceKHR make_surface(const gpu::Device& device) const;

    GLFWwindow* handle() const { return window_; }
    VkExtent2D framebuffer() const;  // pixels; 0 while minimised
    float content_scale() const;     // of its monitor: 2 where letters shall be twice as large
    WindowGeometry place() const;    // to be remembered
    void set_title(const std::string& title);
    void toggle_full_screen();

    // For events, a wake() or so many seconds.
    void wait(double seconds);
    // Takes a portion of what came. Whether anything did.
    bool poll();
    static void wake();  // from any thread
    bool asked_to_close() const;
    void close();
    void keep_open();

    // Of the last portion:
    const std::vector<KeyPress>& presses() const { return presses_; }
    const std::vector<std::filesystem::path>& dropped() const { return dropped_; }
    const std::u32string& typed() const { return typed_; }
    // After ImGui's own platform frame, before its NewFrame: pointer, buttons, keys and letters of the portion.
    void feed_imgui() const;
    // By itself: not since Ctrl was held, whichever of the two is let go first.
    bool is_down(int place) const { return place >= 0 && place < kKeys && keys_[place] && !with_control_[place]; }
    // More waits for the next frame.
    bool has_more() const { return !queue_.empty(); }
    HandledInput handled() const { return {x_, y_, releases_, scrolls_}; }
    // When what the last portion held came, at the earliest; meaningless where it held nothing.
    std::chrono::steady_clock::time_point came() const { return came_; }

  private:
    static constexpr int kKeys = 512, kButtons = 3;
    struct Event {
        enum class Kind { kMove, kButton, kScroll, kKey, kLetter, kFocus } kind;
        int code = 0, scancode = 0, action = 0, mods = 0;
        double x = 0, y = 0;
        std::chrono::steady_clock::time_point came = std::chrono::steady_clock::now();
    };
    void listen();
    bool take(const Event& event);
    void push(const Event& event) { queue_.push_back(event); }
    GLFWwindow* window_ = nullptr;
    std::deque<Event> queue_;
    std::vector<KeyPress> presses_;
    std::vector<std::filesystem::path> dropped_, dropping_;
    std::u32string typed_;
    bool with_control_[kKeys] = {};
    bool keys_[kKeys] = {}, buttons_[kButtons] = {};
    double x_ = -1e9, y_ = -1e9, scroll_x_ = 0, scroll_y_ = 0;
    uint64_t releases_ = 0, scrolls_ = 0;
    std::chrono::steady_clock::time_point came_;
    std::vector<int> changed_;  // of this portion: keys, then kKeys + buttons
    WindowGeometry windowed_;   // where it was before it filled the screen
};

}  // namespace neuvv::ui
