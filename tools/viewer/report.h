// Writes what the window displays to a JSON file: the areas of buttons, the selection, the state of the image. The file
// is for programs that drive the viewer by mouse and keys, such as tests.
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace neuvv::viewer {

class Report {
  public:
    // With an empty path, nothing is written.
    explicit Report(std::filesystem::path file) : file_(std::move(file)) {}
    bool enabled() const { return !file_.empty(); }

    void begin_frame();
    // Adds the area of ImGui's last item under this name, where it is visible.
    void item(const std::string& name);
    // Adds an area, in pixels of the framebuffer.
    void area(const std::string& name, float left, float top, float width, float height);
    // Adds a member beside the areas.
    void fact(const std::string& name, nlohmann::json value);
    // Writes the file where anything has changed, at most 25 times per second. Returns false where a change has to wait
    // for a later frame.
    bool end_frame();

  private:
    std::filesystem::path file_;
    nlohmann::json current_;
    std::string written_;
    std::chrono::steady_clock::time_point last_;
};

}  // namespace neuvv::viewer
