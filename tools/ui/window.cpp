#include "tools/ui/window.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace neuvv::ui {

namespace {

constexpr int kMinWidth = 640, kMinHeight = 400;

std::string glfw_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "unknown";
}

Window& self(GLFWwindow* window) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

// GLFW's key for the letter that is printed on a key, or the key itself where it has none: Ctrl-Z is where Z is
// printed.
int printed_key(int key, int scancode) {
    const char* name = glfwGetKeyName(key, scancode);
    if (name && name[0] >= 'a' && name[0] <= 'z' && name[1] == '\0') return GLFW_KEY_A + (name[0] - 'a');
    return key;
}

// Whether the window's upper edge is on a monitor: a geometry of an earlier run may lie on one that is no longer there.
bool is_on_a_monitor(const WindowGeometry& geometry) {
    int count = 0;
    GLFWmonitor** monitors = glfwGetMonitors(&count);
    for (int i = 0; i < count && geometry.at; ++i) {
        int x = 0, y = 0, width = 0, height = 0;
        glfwGetMonitorWorkarea(monitors[i], &x, &y, &width, &height);
        const int centre = geometry.at->first + geometry.width / 2, top = geometry.at->second;
        if (centre >= x && centre < x + width && top >= y && top < y + height) return true;
    }
    return false;
}

}  // namespace

Window::Window(const std::string& title, const WindowGeometry& geometry) : windowed_(geometry) {
    if (!glfwInit())
        throw RuntimeFailure(
            fmt::format("no window can be opened here ({}); `neuvv render` makes images without one, `neuvv xr` "
                        "needs none without --mirror",
                        glfw_error()));
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_MAXIMIZED, geometry.maximised ? GLFW_TRUE : GLFW_FALSE);
    window_ = glfwCreateWindow(geometry.width, geometry.height, title.c_str(), nullptr, nullptr);
    if (!window_) {
        const std::string error = glfw_error();
        glfwTerminate();
        throw RuntimeFailure(fmt::format("no window can be opened here ({})", error));
    }
    if (is_on_a_monitor(geometry)) glfwSetWindowPos(window_, geometry.at->first, geometry.at->second);
    glfwSetWindowSizeLimits(window_, kMinWidth, kMinHeight, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwSetWindowUserPointer(window_, this);
    set_callbacks();
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void Window::set_callbacks() {
    using Kind = Event::Kind;
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
        std::deque<Event>& queue = self(w).queue_;
        if (!queue.empty() && queue.back().kind == Kind::kMove)
            queue.back().x = x, queue.back().y = y;  // only the last position matters
        else
            self(w).push({Kind::kMove, 0, 0, 0, 0, x, y});
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int mods) {
        self(w).push({Kind::kButton, button, 0, action, mods, 0, 0});
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double x, double y) {
        self(w).push({Kind::kScroll, 0, 0, 0, 0, x, y});
    });
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int scancode, int action, int mods) {
        // If repeats queued up while frames are slow, they would go on after the key is released.
        const std::deque<Event>& queue = self(w).queue_;
        const auto is_queued = [&](const Event& event) { return event.kind == Kind::kKey && event.code == key; };
        if (action == GLFW_REPEAT && std::any_of(queue.begin(), queue.end(), is_queued)) return;
        self(w).push({Kind::kKey, key, scancode, action, mods, 0, 0});
    });
    glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned character) {
        self(w).push({Kind::kCharacter, static_cast<int>(character), 0, 0, 0, 0, 0});
    });
    glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int focused) {
        self(w).push({Kind::kFocus, focused, 0, 0, 0, 0, 0});
    });
    glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
        self(w).dropping_.insert(self(w).dropping_.end(), paths, paths + count);
    });
}

gpu::DeviceExtensions Window::extensions() const {
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (!names)
        throw RuntimeFailure(
            "Vulkan cannot draw into windows here; `neuvv render` makes images without one, `neuvv xr` needs none "
            "without --mirror");
    return {std::vector<const char*>(names, names + count), gpu::kPresentExtensions};
}

VkSurfaceKHR Window::make_surface(const gpu::Device& device) const {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    gpu::check(glfwCreateWindowSurface(device.instance(), window_, nullptr, &surface), "glfwCreateWindowSurface",
               "window");
    return surface;
}

VkExtent2D Window::framebuffer() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) return {0, 0};
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

float Window::content_scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return std::clamp(x, 0.5f, 4.0f);
}

WindowGeometry Window::geometry() const {
    if (glfwGetWindowMonitor(window_)) return windowed_;
    WindowGeometry geometry;
    int x = 0, y = 0;
    glfwGetWindowPos(window_, &x, &y);
    geometry.at = {x, y};
    glfwGetWindowSize(window_, &geometry.width, &geometry.height);
    geometry.maximised = glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) == GLFW_TRUE;
    return geometry;
}

void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(window_, title.c_str());
}

void Window::toggle_full_screen() {
    if (glfwGetWindowMonitor(window_)) {
        const auto [x, y] = windowed_.at.value_or(std::pair(0, 0));
        glfwSetWindowMonitor(window_, nullptr, x, y, windowed_.width, windowed_.height, GLFW_DONT_CARE);
        return;
    }
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    if (!mode) return;
    windowed_ = geometry();
    glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

bool Window::close_requested() const {
    return glfwWindowShouldClose(window_);
}

void Window::close() {
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

void Window::keep_open() {
    glfwSetWindowShouldClose(window_, GLFW_FALSE);
}

void Window::wake() {
    glfwPostEmptyEvent();
}

void Window::wait(double seconds) {
    glfwWaitEventsTimeout(seconds);
}

bool Window::poll() {
    glfwPollEvents();
    presses_.clear();
    typed_.clear();
    changed_.clear();
    scroll_x_ = scroll_y_ = 0;
    dropped_ = std::exchange(dropping_, {});
    const bool any = !queue_.empty() || !dropped_.empty();
    if (!queue_.empty()) came_ = queue_.front().came;
    while (!queue_.empty() && take(queue_.front())) queue_.pop_front();
    return any;
}

// Takes an event into this frame's portion; false where it must wait for the next frame, because it would hide an event
// before it: a button or key that changes twice, or a pointer that moves on after a button has changed.
bool Window::take(const Event& event) {
    const auto changes = [&](int code) {
        if (std::find(changed_.begin(), changed_.end(), code) != changed_.end()) return false;
        changed_.push_back(code);
        return true;
    };
    switch (event.kind) {
        case Event::Kind::kMove:
            if (std::any_of(changed_.begin(), changed_.end(), [](int code) { return code >= kKeys; })) return false;
            x_ = event.x;
            y_ = event.y;
            break;
        case Event::Kind::kButton:
            if (event.code < 0 || event.code >= kButtons) break;
            if (!changes(kKeys + event.code)) return false;
            buttons_[event.code] = event.action == GLFW_PRESS;
            releases_ += event.action == GLFW_RELEASE;
            break;
        case Event::Kind::kScroll:
            scroll_x_ += event.x;
            scroll_y_ += event.y;
            ++scrolls_;
            break;
        case Event::Kind::kKey:
            if (event.code < 0 || event.code >= kKeys) break;
            if (!changes(event.code)) return false;
            keys_[event.code] = event.action != GLFW_RELEASE;
            if (event.action == GLFW_PRESS) with_control_[event.code] = (event.mods & GLFW_MOD_CONTROL) != 0;
            releases_ += event.action == GLFW_RELEASE;
            if (event.action != GLFW_RELEASE)
                presses_.push_back({printed_key(event.code, event.scancode), event.code,
                                    (event.mods & GLFW_MOD_CONTROL) != 0, (event.mods & GLFW_MOD_SHIFT) != 0,
                                    (event.mods & GLFW_MOD_ALT) != 0, event.action == GLFW_REPEAT});
            break;
        case Event::Kind::kCharacter:
            typed_.push_back(static_cast<char32_t>(event.code));
            break;
        case Event::Kind::kFocus:
            if (event.code) break;
            std::fill(std::begin(keys_), std::end(keys_), false);  // releases will go to another window
            std::fill(std::begin(buttons_), std::end(buttons_), false);
            break;
    }
    return true;
}

void Window::feed_imgui() const {
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(static_cast<float>(x_), static_cast<float>(y_));
    for (int i = 0; i < kButtons; ++i) io.MouseDown[i] = buttons_[i];
    io.MouseWheelH += static_cast<float>(scroll_x_);
    io.MouseWheel += static_cast<float>(scroll_y_);
    std::copy(std::begin(keys_), std::end(keys_), std::begin(io.KeysDown));
    io.KeyCtrl = keys_[GLFW_KEY_LEFT_CONTROL] || keys_[GLFW_KEY_RIGHT_CONTROL];
    io.KeyShift = keys_[GLFW_KEY_LEFT_SHIFT] || keys_[GLFW_KEY_RIGHT_SHIFT];
    io.KeyAlt = keys_[GLFW_KEY_LEFT_ALT] || keys_[GLFW_KEY_RIGHT_ALT];
    io.KeySuper = keys_[GLFW_KEY_LEFT_SUPER] || keys_[GLFW_KEY_RIGHT_SUPER];
    for (const char32_t character : typed_) io.AddInputCharacter(static_cast<unsigned>(character));
}

}  // namespace neuvv::ui
