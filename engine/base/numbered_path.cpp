#include "base/numbered_path.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/error.h"

namespace neuvv {

namespace {

// A percent sign, digits and a d.
struct Place {
    size_t begin = 0, end = 0;
    int digits = 0;  // 0: no width that a place has
};

std::optional<Place> find_place(const std::string& text, size_t from = 0) {
    for (size_t begin = text.find('%', from); begin != std::string::npos; begin = text.find('%', begin + 1)) {
        const size_t end = text.find_first_not_of("0123456789", begin + 1);
        if (end == std::string::npos || text[end] != 'd') continue;
        const std::string width = text.substr(begin + 1, end - begin - 1);
        const bool padded = width.size() == 2 && width[0] == '0' && width[1] != '0';
        return Place{begin, end + 1, width.empty() ? 1 : padded ? width[1] - '0' : 0};
    }
    return {};
}

size_t name_begin(const std::string& text) {
    return text.size() - std::filesystem::path(text).filename().string().size();
}

[[noreturn]] void refuse(const Subject& output, const std::string& text, const std::string& problem) {
    const std::string ending = std::filesystem::path(text).extension().string();
    throw InputError(output, text, problem, fmt::format("write it as in out_%04d{}", ending));
}

}  // namespace

std::optional<NumberedPath> NumberedPath::parse(const std::string& text) {
    std::optional<NumberedPath> path;
    for (auto place = find_place(text, name_begin(text)); place; place = find_place(text, place->end)) {
        if (place->digits == 0) continue;
        path.emplace();
        path->before_ = text.substr(0, place->begin);
        path->after_ = text.substr(place->end);
        path->digits_ = place->digits;
    }
    return path;
}

std::optional<NumberedPath> NumberedPath::parse_output(const Subject& output, const std::string& text) {
    const size_t name = name_begin(text);
    std::error_code ignored;
    // "50%dry" is the name of a folder, "shot_%04d" is not.
    for (auto place = find_place(text.substr(0, name)); place; place = find_place(text.substr(0, name), place->end))
        if (place->end - place->begin > 2 && !std::filesystem::is_directory(text.substr(0, name), ignored))
            refuse(output, text,
                   fmt::format("has {} in the name of a folder, but only the file's name has a place for the number",
                               text.substr(place->begin, place->end - place->begin)));
    const auto place = find_place(text, name);
    if (place && (place->digits == 0 || find_place(text, place->end)))
        refuse(output, text, "needs one place for the number");
    return parse(text);
}

std::string NumberedPath::digits(uint64_t number) const {
    return fmt::format("{:0{}}", number, digits_);
}

}  // namespace neuvv
