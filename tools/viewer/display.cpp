#include "tools/viewer/display.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <thread>

#include "base/error.h"

namespace neuvv::viewer {

namespace {

constexpr size_t kMaxMessages = 20;

}  // namespace

Display::Display(const DisplayOptions& options)
    : window("NeuVV", options.geometry),
      screenshots(options.screenshots),
      device_choice_(options.device),
      validation_(options.validate ? gpu::Validation::kOn : gpu::Validation::kOff),
      device_(std::in_place, device_choice_, validation_, window.extensions()),
      screen_(std::in_place, *device_, window,
              options.ui_scale.value_or(static_cast<float>(options.scale_on_monitor) * window.content_scale())),
      begin_(std::chrono::steady_clock::now()) {}

void Display::make_anew(std::string why) {
    const float scale = screen_->scale();
    const gpu::ShaderReplacements shaders = device_->shaders().replacements();
    for (bool is_there = false; !is_there;) {
        screen_.reset();
        device_.reset();
        losses_.note(why, seconds());
        try {
            device_.emplace(device_choice_, validation_, window.extensions());
            screen_.emplace(*device_, window, scale);
            is_there = true;
        } catch (const RuntimeFailure& failure) {
            why = failure.what();
        } catch (const InputError& failure) {  // while a device is reset, none has the name that the user chose
            why = failure.what();
        }
        if (!is_there) std::this_thread::sleep_for(std::chrono::seconds(1));
    }
    device_->shaders().set(shaders);
    screenshots.request_again();
}

double Display::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

bool Display::read(FrameInput& input) {
    const bool event = window.poll();
    const double now_s = seconds();
    input.dt_s = now_s - input.now_s;
    input.now_s = now_s;
    input.event_s.reset();
    if (event) input.event_s = std::chrono::duration<double>(window.came() - begin_).count();
    input.presses = window.presses();
    input.typed = window.typed();
    input.escape = std::any_of(input.presses.begin(), input.presses.end(),
                               [](const ui::KeyPress& press) { return press.key == GLFW_KEY_ESCAPE; });
    const auto axis = [&](int plus, int minus) {
        return (window.is_down(plus) ? 1.0 : 0.0) - (window.is_down(minus) ? 1.0 : 0.0);
    };
    input.flight_keys = {axis(GLFW_KEY_W, GLFW_KEY_S), axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
                         false, false};
    return event;
}

void Display::begin(FrameInput& input) {
    screen_->begin();
    input.flight_keys.fast = ImGui::GetIO().KeyShift;
    input.flight_keys.slow = ImGui::GetIO().KeyAlt;
}

bool Display::end(const FrameInput& input) {
    const Area& area = input.image_area;
    const VkRect2D image_area{{static_cast<int32_t>(area.left), static_cast<int32_t>(area.top)},
                              {static_cast<uint32_t>(area.width), static_cast<uint32_t>(area.height)}};
    return screen_->end({input.rendered.displayed.image, input.rendered.displayed.size, image_area});
}

void Display::set_title(std::string title) {
    if (title == title_) return;
    title_ = std::move(title);
    window.set_title(title_);
}

const std::vector<std::string>& Display::validation_messages() {
    for (std::string& message : device_->drain_validation_messages())
        if (validation_messages_.size() < kMaxMessages) validation_messages_.push_back(std::move(message));
    return validation_messages_;
}

}  // namespace neuvv::viewer
