#include "tools/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/platform.h"
#include "tools/remedies.h"
#include "tools/say.h"
#include "voctree/files/world_frame.h"

namespace neuvv::tools {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTerminalPeriod{200}, kLogPeriod{10000};

// From one line of a log to the next: NEUVV_STATUS_MS, which the window sets for the verbs that it runs, else
// kLogPeriod.
milliseconds log_period() {
    const char* wanted = std::getenv("NEUVV_STATUS_MS");
    const long long ms = wanted ? std::strtoll(wanted, nullptr, 10) : 0;
    return ms > 0 ? milliseconds(std::min(ms, 3'600'000LL)) : kLogPeriod;
}

}  // namespace

StatusLine::StatusLine(bool at_once)
    : terminal_(stderr_is_terminal()), period_(terminal_ ? kTerminalPeriod : log_period()), next_(Clock::now()) {
    if (!terminal_ && !at_once) next_ += period_;
}

bool StatusLine::is_due() {
    const Clock::time_point now = Clock::now();
    if (now < next_) return false;
    next_ = now + period_;
    return true;
}

void StatusLine::print(const std::string& text) {
    if (terminal_) {
        say("\r{:<{}}", text, printed_);  // over the whole line that is there
        printed_ = text.size();
    } else {
        say("{}\n", text);
    }
    std::fflush(stderr);
}

void StatusLine::end() {
    if (std::exchange(printed_, 0) > 0) say("\n");
}

Progress::Progress(std::string label, uint64_t total)
    : label_(std::move(label)), total_(total), start_(std::chrono::steady_clock::now()), line_(false) {}

void Progress::update(uint64_t done, std::string detail) {
    done_ = done;
    detail_ = std::move(detail);
    unprinted_ = true;
    if (line_.is_due()) print();
}

void Progress::finish() {
    if (unprinted_) print();
    line_.end();
}

void Progress::print() {
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    std::string text = fmt::format("{} {}/{}  elapsed {}", label_, done_, total_, format_duration(elapsed));
    if (done_ > 0 && done_ < total_)
        text += "  ETA " + format_duration(elapsed * static_cast<double>(total_ - done_) / static_cast<double>(done_));
    if (!detail_.empty()) text += "  " + detail_;
    line_.print(text);
    unprinted_ = false;
}

std::string format_duration(double seconds) {
    if (!(seconds >= 0) || seconds > 1e7) return "?";
    if (seconds < 60) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<uint64_t>(seconds);
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string size_text(uint64_t bytes) {
    constexpr const char* kUnits[] = {"kB", "MB", "GB", "TB"};
    if (bytes < 1000) return fmt::format("{} B", bytes);
    double size = static_cast<double>(bytes) / 1000;
    size_t unit = 0;
    for (; size >= 1000 && unit + 1 < std::size(kUnits); ++unit) size /= 1000;
    return fmt::format("{:.1f} {}", size, kUnits[unit]);
}

const char* profile_name(gpu::BufferProfile profile) {
    return profile == gpu::BufferProfile::kTexel ? "texel" : "storage";
}

std::string profile_text(const gpu::BufferLimits& limits) {
    const bool texel = limits.profile == gpu::BufferProfile::kTexel;
    const std::string name = fmt::format("{} buffers", profile_name(limits.profile));
    if (limits.reason == gpu::ProfileReason::kForced) return name + " (by NEUVV_BUFFERS)";
    if (limits.reason == gpu::ProfileReason::kLimits) return name + " (by the device's limits)";
    if (!limits.times) return name + " (not timed yet)";
    const auto [texel_ms, storage_ms] = *limits.times;
    return fmt::format("{} ({:.2f} ms, {} buffers {:.2f} ms)", name, texel ? texel_ms : storage_ms,
                       texel ? "storage" : "texel", texel ? storage_ms : texel_ms);
}

bool trace_wanted() {
    const char* value = std::getenv("NEUVV_TRACE");
    return value && *value && std::string_view(value) != "0";
}

std::string pass_times_text(const std::vector<gpu::PassTime>& times) {
    std::string text;
    double sum = 0;
    for (const gpu::PassTime& pass : times) {
        text += fmt::format("{} {:.2f} ms, ", pass.name, pass.milliseconds);
        sum += pass.milliseconds;
    }
    return text + fmt::format("together {:.2f} ms", sum);
}

std::string doubtful_mattes_text(const training::Dataset& dataset, const std::vector<training::DoubtfulMatte>& mattes) {
    constexpr size_t kMaxLines = 10;
    std::string text;
    for (size_t i = 0; i < std::min(mattes.size(), kMaxLines); ++i)
        text +=
            fmt::format("doubtful matte: {} lacks about {:.1f} % of the body that the other images of its time show\n",
                        dataset.views[mattes[i].view].name, 100 * mattes[i].share);
    if (mattes.size() > kMaxLines) text += fmt::format("doubtful mattes: {} more\n", mattes.size() - kMaxLines);
    if (!mattes.empty())
        text +=
            "what doubtful mattes lack is not used; repair them (`neuvv matte`, or by hand in mattes/), or leave these "
            "images out\n";
    return text;
}

nlohmann::ordered_json capture_json(const std::filesystem::path& clip) {
    const voctree::WorldFrame frame = voctree::read_world_frame(clip);
    if (frame.is_same()) return nullptr;
    return {{"origin", {frame.origin.x, frame.origin.y, frame.origin.z}}, {"unit", frame.unit}};
}

std::string capture_line(const std::filesystem::path& clip) {
    const voctree::WorldFrame frame = voctree::read_world_frame(clip);
    if (frame.is_same()) return "";
    const glm::dvec3& o = frame.origin;
    return fmt::format("capture ({:.15g}, {:.15g}, {:.15g}) is the clip's origin, {:.6g} of its units a metre here\n",
                       o.x, o.y, o.z, frame.unit);
}

void say_notes(const std::string& file, const std::vector<std::string>& notes) {
    for (const std::string& note : notes) say("note: {} {}\n", file, note);
}

void say_not_shown(const std::vector<Note>& problems) {
    for (const Note& problem : problems) say("neuvv: not shown: {}\n", message_of(problem));
}

void say_remarks(const std::vector<std::string>& remarks) {
    for (const std::string& remark : remarks) say("note: {}\n", remark);
}

}  // namespace neuvv::tools
