#include "tools/headset/draw/notice_plate.h"

#include <algorithm>
#include <sstream>

#include "tools/headset/draw/label_font.h"

namespace neuvv::headset {

namespace {

constexpr double kAway_m = 0.8, kPlateLine_rad = glm::radians(1.3);
constexpr double kBelow_rad = glm::radians(14.0), kLag_rad = glm::radians(8.0);
constexpr double kKept_s = 2;
constexpr double kPanelInView_rad = glm::radians(28.0);

size_t letters_of(const std::string& utf8) {
    return static_cast<size_t>(
        std::count_if(utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

bool is_in_view(const PanelPlacement& panel, const xr::Pose& head) {
    const glm::dvec3 towards = panel.world_from_panel.position - head.position;
    const double distance_m = glm::length(towards);
    return glm::dot(towards, xr::forward_of(head)) > distance_m * std::cos(kPanelInView_rad);
}

}  // namespace

std::vector<std::string> plate_lines(const std::string& text) {
    constexpr size_t kWidth = LabelFont::kMaxLetters;
    std::istringstream words(text);
    std::vector<std::string> lines;
    for (std::string word; words >> word;) {
        const bool fits = !lines.empty() && letters_of(lines.back()) + 1 + letters_of(word) <= kWidth;
        if (fits) {
            lines.back() += " " + word;
        } else if (lines.size() < NoticePlate::kLines) {
            lines.push_back(word);  // LabelFont shortens a word that is longer than a line
        } else {
            std::string& last = lines.back();
            while (letters_of(last) > kWidth - 2 && last.find(' ') != std::string::npos) last.erase(last.rfind(' '));
            last += " …";
            break;
        }
    }
    return lines;
}

void NoticePlate::show(const editor::Notice& notice) {
    if (!notice.error && error_s_ < kKept_s) return;  // so that an error can be read
    is_new_ = left_s_ <= 0;
    lines_ = plate_lines(notice.text);
    left_s_ = notice.error ? kErrorShown_s : kShown_s;
    if (notice.error && !is_pulsing()) error_s_ = 0;
}

void NoticePlate::update(const xr::Pose& world_head, const std::optional<PanelPlacement>& panel, double dt_s) {
    const auto begins = [&](double pulse_s) { return error_s_ <= pulse_s && error_s_ + dt_s > pulse_s; };
    pulse_begins_ = begins(0) || begins(kNextPulse_s);
    error_s_ += dt_s;
    left_s_ -= dt_s;
    shown_.clear();
    if (left_s_ <= 0 || (panel && is_in_view(*panel, world_head))) return;
    shown_ = lines_;
    const double lag_rad = std::exchange(is_new_, false) ? 0 : kLag_rad;
    const double yaw_rad = xr::yaw_of(world_head.rotation),
                 pitch_rad = std::asin(std::clamp(xr::forward_of(world_head).y, -1.0, 1.0)) - kBelow_rad;
    const double behind_rad = std::remainder(yaw_rad_ - yaw_rad, 2 * glm::pi<double>());
    yaw_rad_ = yaw_rad + std::clamp(behind_rad, -lag_rad, lag_rad);
    pitch_rad_ = pitch_rad + std::clamp(pitch_rad_ - pitch_rad, -lag_rad, lag_rad);
    world_from_plate_.rotation = xr::turn_by(yaw_rad_) * glm::angleAxis(pitch_rad_, glm::dvec3(1, 0, 0));
    world_from_plate_.position = world_head.position + world_from_plate_.rotation * glm::dvec3(0, 0, -kAway_m);
}

double NoticePlate::line_m() const {
    return kAway_m * kPlateLine_rad;
}

}  // namespace neuvv::headset
