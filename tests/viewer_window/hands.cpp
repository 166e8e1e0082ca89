#include "viewer_window/hands.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <thread>

#include "base/platform.h"
#include "support/temporary_folder.h"

namespace neuvv::test {

namespace {

using nlohmann::json;
constexpr auto kPollInterval = std::chrono::milliseconds(10);
constexpr int kDragSteps = 12;

bool is_installed(const std::string& program) {
    std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
    return false;
}

// Returns false where the condition is not true after kTimeout, or when the process has ended.
bool wait_for(const ChildProcess& process, const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + kTimeout;
    while (!condition()) {
        if (process.ended() || std::chrono::steady_clock::now() > end) return condition();
        std::this_thread::sleep_for(kPollInterval);
    }
    return true;
}

std::string text_of(double pixels) {
    return std::to_string(std::lround(pixels));
}

std::set<std::filesystem::path> files_in(const std::filesystem::path& folder) {
    std::set<std::filesystem::path> files;
    if (!std::filesystem::exists(folder)) return files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".png") files.insert(entry.path());
    return files;
}

}  // namespace

std::string why_no_hands() {
    for (const char* program : {"Xvfb", "xdotool"})
        if (!is_installed(program)) return std::string(program) + " is not installed (tools/install-packages test)";
    return "";
}

VirtualScreen::VirtualScreen(const std::filesystem::path& folder) : framebuffer_(folder / "Xvfb_screen0") {
    const std::filesystem::path log = folder / "xvfb.log";
    server_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{"/usr/bin/env", "Xvfb", "-displayfd", "1", "-screen", "0", "1280x800x24", "-dpi", "96",
                                 "-nolisten", "tcp", "-fbdir", folder.string()},
        log);
    const auto number = [&]() -> std::string {
        std::istringstream lines(read_text(log));
        for (std::string line; std::getline(lines, line);)
            if (!lines.eof() && !line.empty() && line.find_first_not_of("0123456789") == std::string::npos) return line;
        return "";
    };
    if (!wait_for(*server_, [&] { return !number().empty(); }))
        throw std::runtime_error("Xvfb does not start: " + read_text(log));
    display_ = ":" + number();
}

// The file is an X window dump: a header of big-endian numbers, then colours of 12 bytes each, then rows of pixels: B,
// G, R and an unused byte.
media::Image VirtualScreen::image() const {
    const std::vector<uint8_t> dump = read_file(framebuffer_);
    const auto number = [&](size_t which) {
        const uint8_t* at = dump.data() + 4 * which;
        return uint32_t{at[0]} << 24 | uint32_t{at[1]} << 16 | uint32_t{at[2]} << 8 | at[3];
    };
    constexpr size_t kHeader = 0, kWidth = 4, kHeight = 5, kRowBytes = 12, kColours = 19, kNumbers = 25;
    if (dump.size() < 4 * kNumbers) throw std::runtime_error("Xvfb has no image");
    const size_t first = number(kHeader) + size_t{12} * number(kColours);
    media::Image image(number(kWidth), number(kHeight));
    if (number(kRowBytes) < 4 * image.width || dump.size() < first + size_t{number(kRowBytes)} * image.height)
        throw std::runtime_error("Xvfb's image is cut off");
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) {
            const uint8_t* from = &dump[first + size_t{number(kRowBytes)} * y + size_t{4} * x];
            std::copy_n(std::array<uint8_t, 4>{from[2], from[1], from[0], 255}.data(), 4, image.at(x, y));
        }
    return image;
}

Hands::Hands(const VirtualScreen& screen, const std::filesystem::path& folder,
             const std::vector<std::string>& arguments, bool validate)
    : display_(screen.display()),
      folder_(folder),
      report_(folder / "report.json"),
      screenshots_(folder / "screenshots"),
      log_(folder / "viewer.log") {
    std::filesystem::remove(report_);
    std::vector<std::string> command{"/usr/bin/env",
                                     "DISPLAY=" + display_,
                                     "XDG_CONFIG_HOME=" + (folder / "config").string(),
                                     "XDG_STATE_HOME=" + (folder / "state").string(),
                                     NEUVV_PROGRAM,
                                     "view"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    for (const std::string& word : {std::string("--report"), report_.string(), std::string("--screenshots"),
                                    screenshots_.string(), std::string("--ui-scale"), std::string("1")})
        command.push_back(word);
    if (validate) command.emplace_back("--validate");
    program_ = std::make_unique<ChildProcess>(command, log_);
    until("a window", [](const json&) { return true; });
    const std::filesystem::path found = folder / "window.txt";
    if (ChildProcess({"/usr/bin/env", "DISPLAY=" + display_, "xdotool", "search", "--sync", "--name", "NeuVV"}, found)
            .wait() != 0)
        throw std::runtime_error("xdotool finds no window: " + read_text(found));
    std::istringstream(read_text(found)) >> window_;
}

Hands::~Hands() {
    if (!std::filesystem::exists(report_)) return;  // there was no window
    EXPECT_EQ(seen().value("validation", json()), json::array()) << "of the validation layers";
}

json Hands::seen() const {
    const json report = json::parse(read_text(report_), nullptr, false);
    return report.is_discarded() ? json() : report;
}

std::string Hands::failure_text(const std::string& what) const {
    json report = seen();
    std::string items;
    if (report.contains("items"))
        for (const auto& [name, area] : report["items"].items()) items += name + " ";
    report.erase("items");
    return "waited in vain for " + what + "; " + (program_->ended() ? "the program ended" : "the program runs") +
           "\nreport: " + report.dump() + "\nitems: " + items + "\nprinted: " + read_text(log_);
}

json Hands::until(const std::string& what, const Condition& condition) const {
    json report;
    const auto holds = [&] {
        report = seen();
        return report.is_object() && condition(report);
    };
    if (!wait_for(*program_, holds)) throw std::runtime_error(failure_text(what));
    return report;
}

json Hands::until_rest() const {
    return until("a finished image", [](const json& report) {
        return report["ready"] == true && report["finished"] == true && report["busy"].empty() &&
               report["handled"]["all"] == true;
    });
}

json Hands::until_notice(const std::string& part) const {
    return until("the notice \"" + part + "\"", [&](const json& report) {
        for (const std::string notice : report["notices"])
            if (notice.find(part) != std::string::npos) return true;
        return false;
    });
}

Spot Hands::centre_of(const std::string& item) const {
    const json report =
        until("the item \"" + item + "\"", [&](const json& now) { return now["items"].contains(item); });
    const std::vector<double> area = report["items"][item];
    return {std::round(area[0] + area[2] / 2), std::round(area[1] + area[3] / 2)};
}

Spot Hands::in_image(double x, double y) const {
    const std::vector<double> area = seen()["items"]["image"];
    return {std::round(area[0] + x * area[2]), std::round(area[1] + y * area[3])};
}

void Hands::xdotool(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"/usr/bin/env", "DISPLAY=" + display_, "xdotool"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const std::filesystem::path log = folder_ / "xdotool.log";
    if (ChildProcess(all, log).wait() != 0) throw std::runtime_error("xdotool " + arguments[0] + ": " + read_text(log));
}

// Acts, then waits until the program has counted so many more inputs, or has ended because of them.
void Hands::after(const char* counter, int more, const std::function<void()>& act) const {
    const uint64_t wanted = seen()["handled"][counter].get<uint64_t>() + static_cast<uint64_t>(more);
    act();
    const auto taken = [&] {
        const json report = seen();
        return report.is_object() && report["handled"][counter] >= wanted && report["handled"]["all"] == true;
    };
    if (!wait_for(*program_, taken) && !program_->ended())
        throw std::runtime_error(failure_text(std::string("input to be taken (") + counter + ")"));
}

void Hands::point(Spot at) {
    xdotool({"mousemove", "--window", window_, text_of(at.x), text_of(at.y)});
    until("the pointer", [&](const json& report) {
        return report["handled"]["x"] == std::round(at.x) && report["handled"]["y"] == std::round(at.y);
    });
}

void Hands::press(int button) {
    xdotool({"mousedown", std::to_string(button)});
}

void Hands::release(int button) {
    after("releases", 1, [&] { xdotool({"mouseup", std::to_string(button)}); });
}

void Hands::click(Spot at, int button) {
    point(at);
    press(button);
    release(button);
}

void Hands::double_click(Spot at) {
    point(at);
    after("releases", 2, [&] { xdotool({"click", "--repeat", "2", "--delay", "30", "1"}); });
}

void Hands::drag(Spot from, Spot to, int button) {
    point(from);
    press(button);
    for (int i = 1; i <= kDragSteps; ++i) {
        const double part = double{1} * i / kDragSteps;
        point({std::round(from.x + part * (to.x - from.x)), std::round(from.y + part * (to.y - from.y))});
    }
    release(button);
}

void Hands::wheel(Spot at, int notches) {
    point(at);
    const int count = std::abs(notches);
    after("scrolls", count, [&] {
        xdotool({"click", "--repeat", std::to_string(count), "--delay", "20", notches > 0 ? "4" : "5"});
    });
}

void Hands::key(const std::string& keys) {
    const auto count = static_cast<int>(1 + std::count(keys.begin(), keys.end(), '+'));
    after("releases", count, [&] { xdotool({"key", keys}); });
}

void Hands::type(const std::string& text) {
    after("releases", static_cast<int>(text.size()), [&] { xdotool({"type", "--delay", "30", text}); });
}

void Hands::resize(int width, int height) {
    xdotool({"windowsize", window_, std::to_string(width), std::to_string(height)});
}

void Hands::minimise() {
    xdotool({"windowunmap", window_});
}

// Without a window manager, the window has to be given the keyboard.
void Hands::show_again() {
    xdotool({"windowmap", "--sync", window_, "windowfocus", window_});
}

media::Image Hands::new_screenshot(const std::string& keys) {
    const auto before = files_in(screenshots_);
    key(keys);
    std::filesystem::path file;
    until("a screenshot", [&](const json&) {
        for (const auto& now : files_in(screenshots_))
            if (!before.count(now)) file = now;
        return !file.empty();
    });
    return media::read_png(file);
}

media::Image Hands::image() {
    until_rest();
    return new_screenshot("F12");
}

media::Image Hands::window() {
    return new_screenshot("shift+F12");
}

int Hands::wait_for_end() {
    if (!wait_for(*program_, [&] { return program_->ended(); })) throw std::runtime_error(failure_text("its end"));
    return program_->wait();
}

void Hands::kill() {
    program_->send(SIGKILL);
    program_->wait();
}

}  // namespace neuvv::test
