#include "tools/viewer/report.h"

#include <imgui.h>

#include "base/error.h"
#include "base/new_file.h"

namespace neuvv::viewer {

namespace {
constexpr auto kMinInterval = std::chrono::milliseconds(40);
}

void Report::begin_frame() {
    if (enabled()) current_ = {{"items", nlohmann::json::object()}};
}

void Report::item(const std::string& name) {
    if (!enabled() || !ImGui::IsItemVisible()) return;
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    area(name, low.x, low.y, high.x - low.x, high.y - low.y);
}

void Report::area(const std::string& name, float left, float top, float width, float height) {
    if (enabled()) current_["items"][name] = {left, top, width, height};
}

void Report::fact(const std::string& name, nlohmann::json value) {
    if (enabled()) current_[name] = std::move(value);
}

bool Report::end_frame() {
    if (!enabled()) return true;
    const std::string text = current_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (text == written_) return true;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < kMinInterval) return false;
    // Written under another name first, so that no reader sees a half-written file. It is not synchronised to the disk:
    // after a power cut nobody needs it.
    try {
        NewFile file(file_);
        file.write(text.data(), text.size());
        file.finish(NewFile::Sync::kNo);
    } catch (const RuntimeFailure&) {  // nobody reads a report that cannot be written
    }
    last_ = now;
    written_ = text;
    return true;
}

}  // namespace neuvv::viewer
