// The two forms of a TimeMap: text, for people, and JSON, for files.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/error.h"
#include "base/text.h"
#include "stage/time_map.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

constexpr double kMinFactor = 1e-3, kMaxFactor = 1e3;

// An operator's name and the names of its times in JSON.
struct VerbForm {
    TimeVerb verb;
    const char* name;
    const char* times[2];
    bool optional;  // whether the times may be left out
};
constexpr VerbForm kForms[] = {
    {TimeVerb::kOffset, "offset", {"by", nullptr}, false},
    {TimeVerb::kSpeed, "speed", {nullptr, nullptr}, false},
    {TimeVerb::kPause, "pause", {"at", "for"}, false},
    {TimeVerb::kFreeze, "freeze", {"at", nullptr}, false},
    {TimeVerb::kClip, "clip", {"from", "to"}, false},
    {TimeVerb::kReverse, "reverse", {nullptr, nullptr}, false},
    {TimeVerb::kJump, "jump", {"at", "to"}, false},
    {TimeVerb::kLoop, "loop", {"from", "to"}, true},
    {TimeVerb::kPingPong, "ping-pong", {"from", "to"}, true},
    {TimeVerb::kHold, "hold", {nullptr, nullptr}, false},
};

const VerbForm& form_of(TimeVerb verb) {
    for (const VerbForm& form : kForms)
        if (form.verb == verb) return form;
    return kForms[0];
}

const VerbForm& form_named(const std::string& name, const std::string& file, const std::string& place) {
    std::string names;
    for (const VerbForm& form : kForms) {
        if (name == form.name) return form;
        names += (names.empty() ? "" : ", ") + std::string(form.name);
    }
    throw InputError(file, place, fmt::format("there is no operator \"{}\"", name), "choose from " + names);
}

size_t time_count(const VerbForm& form) {
    return form.times[0] == nullptr ? 0 : form.times[1] == nullptr ? 1 : 2;
}

bool read_number(std::string_view text, double& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

double checked_factor(double factor, const std::string& file, const std::string& place) {
    if (!(factor >= kMinFactor && factor <= kMaxFactor))
        throw InputError(file, place, fmt::format("a speed is a number from {} to {}", kMinFactor, kMaxFactor),
                         "for standstill use freeze, for backwards reverse");
    return factor;
}

// Checks an operator of either form. Throws InputError.
void check(const TimeOperator& op, const std::string& file, const std::string& place) {
    const bool may_be_negative = op.verb == TimeVerb::kOffset;
    if (!may_be_negative && (op.a.value < 0 || op.b.value < 0))
        throw InputError(file, place, "has a time before the clip's start", "only an offset may be negative");
}

TimeOperator parse_operator(const std::string& text, const std::string& file, const std::string& place) {
    const std::vector<std::string> words = split(text, ':');
    const VerbForm& form = form_named(words[0], file, place);
    TimeOperator op;
    op.verb = form.verb;
    const size_t given = words.size() - 1;
    if (op.verb == TimeVerb::kSpeed) {
        double factor = NAN;
        if (given != 1 || !read_number(words[1], factor))
            throw InputError(file, place, fmt::format("\"{}\" is no speed", text), "write it as in speed:0.5");
        op.factor = checked_factor(factor, file, place);
        return op;
    }
    op.has_part = given > 0 || !form.optional;
    if (given != time_count(form) && !(form.optional && given == 0))
        throw InputError(file, place,
                         fmt::format("\"{}\" has {} times, {} takes {}", text, given, form.name, time_count(form)),
                         fmt::format("write it as in {}{}", form.name,
                                     time_count(form) == 0   ? ""
                                     : time_count(form) == 1 ? ":3f"
                                                             : ":1s:2s"));
    if (given > 0) op.a = parse_clip_time(words[1], file, place);
    if (given > 1) op.b = parse_clip_time(words[2], file, place);
    check(op, file, place);
    return op;
}

const ordered_json& member(const ordered_json& json, const char* name, const std::string& file,
                           const std::string& place) {
    const auto found = json.find(name);
    if (found == json.end()) throw InputError(file, place, fmt::format("lacks \"{}\"", name));
    return *found;
}

std::string text_member(const ordered_json& json, const char* name, const std::string& file, const std::string& place) {
    const ordered_json& value = member(json, name, file, place);
    if (!value.is_string()) throw InputError(file, place + "/" + name, "is not a string");
    return value.get<std::string>();
}

TimeOperator operator_of(const ordered_json& json, const std::string& file, const std::string& place) {
    if (!json.is_object()) throw InputError(file, place, "is not an object");
    const VerbForm& form = form_named(text_member(json, "operator", file, place), file, place + "/operator");
    TimeOperator op;
    op.verb = form.verb;
    if (op.verb == TimeVerb::kSpeed) {
        const ordered_json& factor = member(json, "factor", file, place);
        if (!factor.is_number()) throw InputError(file, place + "/factor", "is not a number");
        op.factor = checked_factor(factor.get<double>(), file, place + "/factor");
        return op;
    }
    op.has_part = !form.optional || json.contains("from") || json.contains("to");
    ClipTime* times[] = {&op.a, &op.b};
    for (size_t i = 0; i < time_count(form) && op.has_part; ++i)
        *times[i] = parse_clip_time(text_member(json, form.times[i], file, place), file, place + "/" + form.times[i]);
    check(op, file, place);
    return op;
}

}  // namespace

ClipTime parse_clip_time(const std::string& text, const std::string& file, const std::string& place) {
    ClipTime time;
    const char unit = text.empty() ? ' ' : text.back();
    const bool has_unit = unit == 's' || unit == 'f';
    const std::string_view digits = std::string_view(text).substr(0, text.size() - (has_unit ? 1 : 0));
    const bool number = read_number(digits, time.value);
    if (!number || !(std::abs(time.value) <= kMaxClipTime) || (!has_unit && time.value != 0))
        throw InputError(file, place, fmt::format("\"{}\" is no time", text),
                         "write seconds as in 1.5s, frames of the clip as in 3f");
    time.frames = unit == 'f';
    return time;
}

std::string text_of(const ClipTime& time) {
    return fmt::format("{}{}", time.value, time.frames ? 'f' : 's');
}

TimeMap parse_time_map(const std::string& text, const std::string& file, const std::string& place) {
    TimeMap map;
    if (text.empty()) return map;
    for (const std::string& part : split(text, ',')) map.push_back(parse_operator(part, file, place));
    if (map.size() > kMaxTimeOperators)
        throw InputError(file, place, fmt::format("has more than {} operators", kMaxTimeOperators));
    return map;
}

std::string text_of(const TimeMap& map) {
    std::string text;
    for (const TimeOperator& op : map) {
        const VerbForm& form = form_of(op.verb);
        text += (text.empty() ? "" : ",") + std::string(form.name);
        if (op.verb == TimeVerb::kSpeed) text += fmt::format(":{}", op.factor);
        if (!op.has_part) continue;
        if (time_count(form) > 0) text += ":" + text_of(op.a);
        if (time_count(form) > 1) text += ":" + text_of(op.b);
    }
    return text;
}

TimeMap time_map_of(const ordered_json& json, const std::string& file, const std::string& place) {
    if (!json.is_array()) throw InputError(file, place, "is not a list of operators");
    if (json.size() > kMaxTimeOperators)
        throw InputError(file, place, fmt::format("has more than {} operators", kMaxTimeOperators));
    TimeMap map;
    for (size_t i = 0; i < json.size(); ++i) map.push_back(operator_of(json[i], file, fmt::format("{}/{}", place, i)));
    return map;
}

ordered_json json_of(const TimeMap& map) {
    auto json = ordered_json::array();
    for (const TimeOperator& op : map) {
        const VerbForm& form = form_of(op.verb);
        ordered_json entry = {{"operator", form.name}};
        if (op.verb == TimeVerb::kSpeed) entry["factor"] = op.factor;
        if (op.has_part && time_count(form) > 0) entry[form.times[0]] = text_of(op.a);
        if (op.has_part && time_count(form) > 1) entry[form.times[1]] = text_of(op.b);
        json.push_back(entry);
    }
    return json;
}

}  // namespace neuvv::stage
