// A simulated user of the viewer: starts the built program on a virtual screen (Xvfb), sends real events of mouse and
// keys (xdotool), and reads the report that the program writes about what it displays and where.
//
// Each action returns when the program has handled its events. A condition that does not become true within kTimeout
// throws std::runtime_error with the report and with what the program printed.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "support/child_process.h"

namespace neuvv::test {

constexpr std::chrono::minutes kTimeout{4};  // a busy machine needs long to compile shaders

// A line that says which program is missing on this machine; empty: none is.
std::string why_no_hands();

// An X server of its own, which ends with the object.
class VirtualScreen {
  public:
    explicit VirtualScreen(const std::filesystem::path& folder);
    const std::string& display() const { return display_; }
    // The current contents of the screen. Throws where the server has no image yet.
    media::Image image() const;

  private:
    std::filesystem::path framebuffer_;
    std::unique_ptr<ChildProcess> server_;
    std::string display_;  // ":7"
};

// Pixels of the window.
struct Spot {
    double x = 0, y = 0;
};

class Hands {
  public:
    // Starts `neuvv view` with these arguments and waits for its window. Its configuration, state and screenshots are
    // in `folder`, where another Hands finds them again. `validate`: with the validation layers.
    Hands(const VirtualScreen& screen, const std::filesystem::path& folder, const std::vector<std::string>& arguments,
          bool validate = true);
    // Ends the program, and expects that the validation layers have reported nothing.
    ~Hands();
    Hands(const Hands&) = delete;
    Hands& operator=(const Hands&) = delete;

    // The newest report; null where there is none.
    nlohmann::json seen() const;
    using Condition = std::function<bool(const nlohmann::json& seen)>;
    // Waits until the report fulfils the condition, and returns that report. `what` is for the message of a failure.
    nlohmann::json until(const std::string& what, const Condition& condition) const;
    // Waits until the image of the current document is sharp and no job is under way.
    nlohmann::json until_rest() const;
    // Waits for a notice that contains `part`.
    nlohmann::json until_notice(const std::string& part) const;

    Spot centre_of(const std::string& item) const;  // waits for the item
    // A point of the image: (0, 0) is its upper left corner, (1, 1) its lower right corner.
    Spot in_image(double x, double y) const;

    void point(Spot at);
    void press(int button = 1);
    void release(int button = 1);
    void click(Spot at, int button = 1);
    void click(const std::string& item) { click(centre_of(item)); }
    void double_click(Spot at);
    void drag(Spot from, Spot to, int button = 1);
    void wheel(Spot at, int notches);  // up is positive
    // Names of keys are those of xdotool: "ctrl+z", "space", "F12".
    void key(const std::string& keys);
    void type(const std::string& text);

    // What a window manager does to the window.
    void resize(int width, int height);
    void minimise();
    void show_again();

    // Screenshots by F12 and Shift+F12: the image, once it is sharp, and the window.
    media::Image image();
    media::Image window();

    // Waits until the program has ended by itself, and returns its exit code.
    int wait_for_end();
    void kill();  // by SIGKILL
    bool ended() const { return !program_ || program_->ended(); }

  private:
    void xdotool(const std::vector<std::string>& arguments) const;
    void after(const char* counter, int more, const std::function<void()>& act) const;
    media::Image new_screenshot(const std::string& keys);
    std::string failure_text(const std::string& what) const;

    std::string display_, window_;
    std::filesystem::path folder_, report_, screenshots_, log_;
    std::unique_ptr<ChildProcess> program_;
};

}  // namespace neuvv::test
