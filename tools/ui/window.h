// A window with its input from keyboard and pointer. Events wait in a queue. Each frame takes a portion of them in
// which no button or key changes twice, so that no short press is lost, however long frames take.
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

// A key that was pressed, or repeats. Both numbers are GLFW's: `key` goes by the letter that is printed on the key,
// where it has one, `place` by the position of the key on a keyboard.
struct KeyPress {
    int key = 0, place = 0;
    bool control = false, shift = false, alt = false, repeat = false;
};

// The input that frames have taken so far, for programs that drive the window.
struct HandledInput {
    double x = 0, y = 0;                 // of the pointer, in screen coordinates of the window
    uint64_t releases = 0, scrolls = 0;  // of keys and buttons; events of the wheel
};

class Window {
  public:
    // Throws RuntimeFailure where there is no display.
    Window(const std::string& title, const WindowGeometry& geometry);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    gpu::DeviceExtensions extensions() const;  // that a device needs to present to the window
    VkSurfaceKHR make_surface(const gpu::Device& device) const;

    GLFWwindow* handle() const { return window_; }
    VkExtent2D framebuffer() const;   // pixels; 0 while minimised
    float content_scale() const;      // of its monitor: 2 where text is to be twice as large
    WindowGeometry geometry() const;  // as it is without full screen
    void set_title(const std::string& title);
    void toggle_full_screen();

    // Waits for an event or wake(), at most so many seconds.
    void wait(double seconds);
    // Takes the next portion of events; returns whether there was any event.
    bool poll();
    static void wake();  // may be called from any thread
    // Whether the user or close() has asked for the window to be closed; keep_open() takes that back.
    bool close_requested() const;
    void close();
    void keep_open();

    // Of the last portion:
    const std::vector<KeyPress>& presses() const { return presses_; }
    const std::vector<std::filesystem::path>& dropped() const { return dropped_; }
    const std::u32string& typed() const { return typed_; }
    // Passes pointer, buttons, keys and characters of the portion to ImGui. Call it after ImGui_ImplGlfw_NewFrame() and
    // before ImGui::NewFrame().
    void feed_imgui() const;
    // Whether a key is down that was pressed without Ctrl.
    bool is_down(int place) const { return place >= 0 && place < kKeys && keys_[place] && !with_control_[place]; }
    // Whether events are left for the next frame.
    bool has_more() const { return !queue_.empty(); }
    HandledInput handled() const { return {x_, y_, releases_, scrolls_}; }
    // When the first event of the last portion came; of no meaning where the portion was empty.
    std::chrono::steady_clock::time_point came() const { return came_; }

  private:
    static constexpr int kKeys = 512, kButtons = 3;
    struct Event {
        enum class Kind { kMove, kButton, kScroll, kKey, kCharacter, kFocus } kind;
        int code = 0, scancode = 0, action = 0, mods = 0;
        double x = 0, y = 0;
        std::chrono::steady_clock::time_point came = std::chrono::steady_clock::now();
    };
    void set_callbacks();
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
    std::vector<int> changed_;  // in this portion: keys, and buttons as kKeys + button
    WindowGeometry windowed_;   // the geometry before full screen
};

}  // namespace neuvv::ui
