// What the window shows, as JSON in a file: places of buttons, the selection, the image. For programs that drive the
// viewer by mouse and keys, tests first.
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace neuvv::viewer {

class Report {
  public:
    // Without a file all of this does nothing.
    explicit Report(std::filesystem::path file) : file_(std::move(file)) {}
    bool on() const { return !file_.empty(); }

    void begin_frame();
    // The last item of ImGui, by a name; pixels of the framebuffer: left, top, width, height.
    void item(const std::string& name);
    void place(const std::string& name, float left, float top, float width, float height);
    void fact(const std::string& name, nlohmann::json value);
    // Written where anything changed, at most some times a second; false: it waits for a later frame.
    bool end_frame();

  private:
    std::filesystem::path file_;
    nlohmann::json now_;
    std::string written_;
    std::chrono::steady_clock::time_point last_;
};

}  // namespace neuvv::viewer
