// A person at the viewer: the built program on a screen without a monitor (Xvfb), real events of mouse and keys
// (xdotool), and eyes, which are the report that the program keeps of what it shows and where.
//
// Every verb returns when the program has taken its events. What does not come about in kTimeout throws, with the
// report and what the program printed.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "support/child_process.h"

namespace neuvv::test {

constexpr std::chrono::minutes kTimeout{4};  // a busy machine compiles shaders for long

// What is missing to have hands here, in a line; empty: nothing.
std::string why_no_hands();

// An X server of its own, until the end of the object.
class VirtualScreen {
  public:
    explicit VirtualScreen(const std::filesystem::path& folder);
    const std::string& display() const { return display_; }
    // What a monitor would show now. Throws where the server has no image yet.
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
    // `neuvv view` with these arguments; its configuration, state and screenshots go into folders of `folder`, where
    // another Hands finds them again. Waits for the window. `validate`: with the validation layers.
    Hands(const VirtualScreen& screen, const std::filesystem::path& folder, const std::vector<std::string>& arguments,
          bool validate = true);
    // Ends the program, and expects that the validation layers had nothing to say.
    ~Hands();
    Hands(const Hands&) = delete;
    Hands& operator=(const Hands&) = delete;

    // The newest report.
    nlohmann::json seen() const;
    using Condition = std::function<bool(const nlohmann::json& seen)>;
    // Waits for it; the report that fulfils it.
    nlohmann::json until(const std::string& what, const Condition& condition) const;
    // The image of the document as it is, sharp; nothing is under way.
    nlohmann::json until_rest() const;
    nlohmann::json until_notice(const std::string& part) const;

    Spot middle_of(const std::string& item) const;  // waits for the item
    // Of the image: 0, 0 is its upper left, 1, 1 its lower right.
    Spot in_image(double x, double y) const;

    void point(Spot at);
    void press(int button = 1);
    void release(int button = 1);
    void click(Spot at, int button = 1);
    void click(const std::string& item) { click(middle_of(item)); }
    void double_click(Spot at);
    void drag(Spot from, Spot to, int button = 1);
    void wheel(Spot at, int notches);  // up is positive
    // As xdotool has them: "ctrl+z", "space", "F12".
    void key(const std::string& keys);
    void type(const std::string& text);

    // Of the window as a window manager would.
    void resize(int width, int height);
    void minimise();
    void show_again();

    // F12 and Shift-F12: the file that appears.
    media::Image image();
    media::Image window();

    // The exit code, once the program has ended by itself.
    int wait_for_end();
    void kill();  // at once, without a word
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
