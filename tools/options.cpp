#include "tools/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "base/text.h"
#include "media/image.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

namespace {

constexpr double kMaxNumber = 1e9;  // in a list of numbers

// CSS's basic colours.
constexpr std::pair<const char*, const char*> kColours[] = {
    {"white", "ffffff"},   {"silver", "c0c0c0"}, {"grey", "808080"},   {"gray", "808080"},  {"black", "000000"},
    {"red", "ff0000"},     {"maroon", "800000"}, {"yellow", "ffff00"}, {"olive", "808000"}, {"lime", "00ff00"},
    {"green", "008000"},   {"aqua", "00ffff"},   {"teal", "008080"},   {"blue", "0000ff"},  {"navy", "000080"},
    {"fuchsia", "ff00ff"}, {"purple", "800080"},
};

// The whole of `text` as a number.
template <typename T>
bool read_number(std::string_view text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

media::ImageSize parse_size(const std::string& text) {
    media::ImageSize size;
    const size_t cross = std::min(text.find('x'), text.size());
    const bool numbers = cross < text.size() && read_number(std::string_view(text).substr(0, cross), size.width) &&
                         read_number(std::string_view(text).substr(cross + 1), size.height);
    if (!numbers || size.width == 0 || size.height == 0 || std::max(size.width, size.height) > media::kMaxImageSide)
        throw InputError("--size", text, fmt::format("is not an image's size of 1 to {} a side", media::kMaxImageSide),
                         "write WIDTHxHEIGHT, as in 1280x720");
    return size;
}

std::vector<double> parse_numbers(const std::string& option, const std::string& text, size_t count,
                                  const std::string& fix) {
    std::vector<double> numbers;
    for (const std::string& part : split(text, ',')) {
        double number = NAN;
        const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), number);
        if (error == std::errc::result_out_of_range)
            number = std::strtod(part.c_str(), nullptr);  // huge, or so small that it is 0
        if (stop != part.data() + part.size()) number = NAN;
        if (std::abs(number) > kMaxNumber)
            throw InputError(option, text, fmt::format("is too large: {} is the most", kMaxNumber), fix);
        numbers.push_back(number);
    }
    bool valid = numbers.size() == count;
    for (const double number : numbers) valid = valid && std::isfinite(number);
    if (!valid)
        throw InputError(option, text, count == 1 ? "is no number" : fmt::format("is not {} numbers", count), fix);
    return numbers;
}

uint32_t parse_frames(const std::string& option, const std::string& text, double fps) {
    constexpr const char* kFix = "write for instance 8 for frames, 0.5s for seconds, or 2:10 for minutes and seconds";
    const size_t colon = text.find(':');
    const bool in_seconds = text.ends_with('s') || colon != std::string::npos;
    double number = 0;
    if (colon != std::string::npos)
        number = 60 * parse_numbers(option, text.substr(0, colon), 1, kFix)[0] +
                 parse_numbers(option, text.substr(colon + 1), 1, kFix)[0];
    else
        number = parse_numbers(option, in_seconds ? text.substr(0, text.size() - 1) : text, 1, kFix)[0];
    if (in_seconds && fps <= 0) throw InputError(option, text, "needs a frame rate, which is not known here", kFix);
    const double frames = std::round(in_seconds ? number * fps : number);
    if (frames < 0 || frames > voctree::kMaxClipFrames)
        throw InputError(option, text, fmt::format("is {} frames", frames), kFix);
    return static_cast<uint32_t>(frames);
}

glm::vec4 parse_colour(const std::string& option, const std::string& text) {
    const std::string name = lower_case(text);
    if (name == "clear" || name == "transparent" || name == "none") return glm::vec4(0);
    std::string hex = name, names;
    for (const auto& [known, digits] : kColours) {
        if (name == known) hex = digits;
        names += std::string(known) + ", ";
    }
    if (!hex.empty() && hex[0] == '#') hex.erase(0, 1);
    const bool digits =
        hex.size() == 6 && std::all_of(hex.begin(), hex.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
    if (!digits) throw InputError(option, text, "is not a colour", "write '#rrggbb', " + names + "or clear");
    const auto rgb = static_cast<uint32_t>(std::stoul(hex, nullptr, 16));
    glm::vec4 colour(1);
    for (int c = 0; c < 3; ++c)
        colour[c] = static_cast<float>(media::linear_from_srgb((rgb >> (16 - 8 * c) & 255u) / 255.0));
    return colour;
}

FrameRange parse_frame_range(const std::string& text, uint32_t frames) {
    const double end = frames > 0 ? frames - 1 : 0;
    FrameRange range{0, end};
    if (text.empty()) return range;
    const size_t colon = text.find(':');
    const std::string_view whole = text, first = whole.substr(0, colon);
    bool valid = first.empty() ? colon != std::string::npos : read_number(first, range.first);
    if (colon == std::string::npos)
        range.last = range.first;
    else if (colon + 1 < text.size())
        valid = valid && read_number(whole.substr(colon + 1), range.last);
    if (!valid || !(range.first >= 0) || !(range.first <= range.last) || !(range.last <= end))
        throw InputError("--frames", text, "is not a part of the clip",
                         fmt::format("write FIRST:LAST within 0:{}, as in 0:{}", end, end));
    return range;
}

}  // namespace neuvv::tools
