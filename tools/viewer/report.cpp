#include "tools/viewer/report.h"

#include <imgui.h>

#include <fstream>

namespace neuvv::viewer {

namespace {
constexpr auto kBetween = std::chrono::milliseconds(40);
}

void Report::begin_frame() {
    if (on()) now_ = {{"items", nlohmann::json::object()}};
}

void Report::item(const std::string& name) {
    if (!on() || !ImGui::IsItemVisible()) return;
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    place(name, low.x, low.y, high.x - low.x, high.y - low.y);
}

void Report::place(const std::string& name, float left, float top, float width, float height) {
    if (on()) now_["items"][name] = {left, top, width, height};
}

void Report::fact(const std::string& name, nlohmann::json value) {
    if (on()) now_[name] = std::move(value);
}

bool Report::end_frame() {
    if (!on()) return true;
    const std::string text = now_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (text == written_) return true;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < kBetween) return false;
    // Renamed, so that no reader sees a half; not synced: nobody needs it after a power cut.
    const std::filesystem::path part = file_.string() + ".part";
    std::ofstream(part, std::ios::binary) << text;
    std::error_code error;
    std::filesystem::rename(part, file_, error);
    last_ = now;
    written_ = text;
    return true;
}

}  // namespace neuvv::viewer
