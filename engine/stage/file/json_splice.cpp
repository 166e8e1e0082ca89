#include "stage/file/json_splice.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "base/error.h"
#include "base/formats/json.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

constexpr size_t kMaxMatchedPairs = size_t{1} << 21;  // pairs of list elements that are compared with each other

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

size_t skip_space(std::string_view text, size_t at) {
    while (at < text.size() && is_space(text[at])) ++at;
    return at;
}

// One past the end of the value that begins at `at`; the text must be valid JSON.
size_t value_end(std::string_view text, size_t at) {
    int depth = 0;
    do {
        const char c = text[at];
        if (c == '"') {
            for (++at; text[at] != '"'; ++at)
                if (text[at] == '\\') ++at;
        } else if (c == '{' || c == '[') {
            ++depth;
        } else if (c == '}' || c == ']') {
            --depth;
        } else if (depth == 0) {  // a number, true, false or null
            while (at < text.size() && text[at] != ',' && text[at] != '}' && text[at] != ']' && !is_space(text[at]))
                ++at;
            return at;
        }
        ++at;
    } while (depth > 0);
    return at;
}

// Offsets of a member or an element in the text. `begin` is that of its key where it has one, else that of its value.
struct Part {
    size_t begin = 0, key_end = 0, value = 0, end = 0;
};

// The parts of the object or list that begins at `at`; `close` becomes the offset of its closing bracket.
std::vector<Part> parts_of(std::string_view text, size_t at, size_t& close) {
    const bool object = text[at] == '{';
    std::vector<Part> parts;
    at = skip_space(text, at + 1);
    while (text[at] != '}' && text[at] != ']') {
        Part part{at, at, at, at};
        if (object) {
            part.key_end = value_end(text, at);
            part.value = skip_space(text, skip_space(text, part.key_end) + 1);
        }
        part.end = value_end(text, part.value);
        parts.push_back(part);
        at = skip_space(text, part.end);
        if (text[at] == ',') at = skip_space(text, at + 1);
    }
    close = at;
    return parts;
}

// The white space at the beginning of the line that contains `at`.
std::string indent_at(std::string_view text, size_t at) {
    size_t line = text.rfind('\n', at);
    line = line == std::string_view::npos ? 0 : line + 1;
    size_t end = line;
    while (end < at && (text[end] == ' ' || text[end] == '\t')) ++end;
    return std::string(text.substr(line, end - line));
}

std::string after_last_newline(const std::string& space) {
    const size_t newline = space.rfind('\n');
    return newline == std::string::npos ? "" : space.substr(newline + 1);
}

// How the document is laid out, derived from its first member.
struct Style {
    bool lines = false;  // each member has its own line
    std::string newline = "\n", unit = "  ", colon = ":";
};

Style style_of(std::string_view text, size_t root) {
    Style style;
    if (text[root] != '{' && text[root] != '[') return style;
    size_t close = 0;
    const std::vector<Part> parts = parts_of(text, root, close);
    if (parts.empty()) return style;
    const std::string lead(text.substr(root + 1, parts[0].begin - root - 1));
    style.lines = lead.find('\n') != std::string::npos;
    if (lead.find("\r\n") != std::string::npos) style.newline = "\r\n";
    if (style.lines && !after_last_newline(lead).empty()) style.unit = after_last_newline(lead);
    if (text[root] == '{') style.colon = std::string(text.substr(parts[0].key_end, parts[0].value - parts[0].key_end));
    if (style.colon.find('\n') != std::string::npos) style.colon = ": ";
    return style;
}

bool is_container(const ordered_json& value) {
    return value.is_object() || value.is_array();
}

bool holds_containers(const ordered_json& value) {
    return std::any_of(value.begin(), value.end(), [](const ordered_json& part) { return is_container(part); });
}

// The text of a new value. A list without objects and lists in it goes into one line.
std::string laid_out(const ordered_json& value, const Style& style, bool lines, const std::string& indent) {
    if (!is_container(value) || value.empty()) return value.dump();
    const bool broken = lines && (value.is_object() || holds_containers(value));
    const std::string inner = indent + style.unit;
    std::string text(1, value.is_object() ? '{' : '[');
    bool first = true;
    for (auto part = value.begin(); part != value.end(); ++part) {
        if (!first) text += broken || !style.colon.ends_with(' ') ? "," : ", ";
        if (broken) text += style.newline + inner;
        if (value.is_object()) text += ordered_json(part.key()).dump() + style.colon;
        text += laid_out(*part, style, lines, inner);
        first = false;
    }
    if (broken) text += style.newline + indent;
    return text + (value.is_object() ? '}' : ']');
}

// The members of an object, in the object's order.
using Members = std::vector<std::pair<std::string_view, const ordered_json*>>;

Members members_of(const ordered_json& object) {
    Members members;
    for (const auto& [name, value] : object.get_ref<const ordered_json::object_t&>())
        members.emplace_back(name, &value);
    return members;
}

const ordered_json* find(const Members& members, std::string_view name) {
    const auto found = std::find_if(members.begin(), members.end(), [&](const auto& m) { return m.first == name; });
    return found == members.end() ? nullptr : found->second;
}

// The index of a part that is not in the text yet.
constexpr size_t kNew = SIZE_MAX;

// The cost of changing a value into another: 0 for equal values, 2 for values that have nothing in common.
double difference(const ordered_json& a, const ordered_json& b) {
    if (a == b) return 0;
    if (a.type() != b.type()) return a.is_number() && b.is_number() ? 1 : 2;
    if (!a.is_object()) return 1;
    size_t same = 0;
    for (const auto& [key, value] : a.items()) same += b.contains(key) && b[key] == value;
    return 0.5 + 1.5 * (1 - static_cast<double>(same) / static_cast<double>(std::max(a.size(), b.size())));
}

// For each element of `edited` the index of the element of `original` that it is matched with, or kNew; the indices
// ascend. The matching is that of the cheapest edit from one list to the other, where removing and adding an element
// cost 1 each and changing one costs its difference(). Lists of equal length, and those that are too long for this, are
// matched index by index between their equal ends.
std::vector<size_t> matched(const ordered_json& original, const ordered_json& edited) {
    std::vector<size_t> old_indices(edited.size(), kNew);
    size_t head = 0, tail = 0;
    const size_t shorter = std::min(original.size(), edited.size());
    while (head < shorter && original[head] == edited[head]) ++head;
    while (tail < shorter - head && original[original.size() - 1 - tail] == edited[edited.size() - 1 - tail]) ++tail;
    for (size_t i = 0; i < head; ++i) old_indices[i] = i;
    for (size_t i = 1; i <= tail; ++i) old_indices[edited.size() - i] = original.size() - i;
    const size_t rows = original.size() - head - tail, columns = edited.size() - head - tail;
    if ((rows + 1) * (columns + 1) > kMaxMatchedPairs || rows == columns) {
        for (size_t i = 0; i < std::min(rows, columns); ++i) old_indices[head + i] = head + i;
        return old_indices;
    }
    const size_t width = columns + 1;
    std::vector<double> cost((rows + 1) * width), pair((rows + 1) * width);
    for (size_t r = rows + 1; r-- > 0;)
        for (size_t c = columns + 1; c-- > 0;) {
            double& best = cost[r * width + c];
            if (r == rows || c == columns) {
                best = static_cast<double>(rows - r + columns - c);
                continue;
            }
            pair[r * width + c] = difference(original[head + r], edited[head + c]) + cost[(r + 1) * width + c + 1];
            best = std::min({pair[r * width + c], 1 + cost[(r + 1) * width + c], 1 + cost[r * width + c + 1]});
        }
    for (size_t r = 0, c = 0; r < rows && c < columns;) {
        const double best = cost[r * width + c];
        if (pair[r * width + c] <= best) {
            old_indices[head + c++] = head + r++;
        } else if (1 + cost[(r + 1) * width + c] <= best) {
            ++r;
        } else {
            ++c;
        }
    }
    return old_indices;
}

// A part of the edited container. It is the part `old_index` of the text, changed to `new_value`; or a new part, which
// takes its text from the equal old part `copy_of` where there is one.
struct Change {
    size_t old_index = kNew, copy_of = kNew;
    std::string_view key;
    const ordered_json* old_value = nullptr;
    const ordered_json* new_value = nullptr;
};

// The members in the order of the text, new members last.
std::vector<Change> changes_of_object(const Members& original, const Members& edited) {
    std::vector<Change> changes;
    for (size_t i = 0; i < original.size(); ++i)
        if (const ordered_json* value = find(edited, original[i].first))
            changes.push_back({i, kNew, original[i].first, original[i].second, value});
    for (const auto& [key, value] : edited)
        if (!find(original, key)) changes.push_back({kNew, kNew, key, nullptr, value});
    return changes;
}

std::vector<Change> changes_of_list(const ordered_json& original, const ordered_json& edited) {
    std::vector<Change> changes;
    const std::vector<size_t> old_indices = matched(original, edited);
    for (size_t i = 0; i < old_indices.size(); ++i) {
        Change& change = changes.emplace_back(Change{old_indices[i], kNew, {}, nullptr, &edited[i]});
        if (old_indices[i] != kNew)
            change.old_value = &original[old_indices[i]];
        else if (is_container(edited[i]) && original.size() * original.size() <= kMaxMatchedPairs)
            for (size_t k = 0; k < original.size() && change.copy_of == kNew; ++k)
                if (original[k] == edited[i]) change.copy_of = k;
    }
    return changes;
}

struct Splicer {
    std::string_view text;
    Style style;

    std::string_view between(size_t begin, size_t end) const { return text.substr(begin, end - begin); }

    // The text of the value at `at`, edited. `indent` is used where a new value replaces it.
    std::string value(size_t at, const ordered_json& original, const ordered_json& edited, bool lines,
                      const std::string& indent) const {
        if (&original == &edited || original == edited) return std::string(between(at, value_end(text, at)));
        if (original.type() != edited.type() || !is_container(edited)) return laid_out(edited, style, lines, indent);
        return container(at, edited.is_object() ? changes_of_object(members_of(original), members_of(edited))
                                                : changes_of_list(original, edited));
    }

    // The text of an object or list. Between two parts that were kept, the old separator stays.
    std::string container(size_t at, const std::vector<Change>& changes) const {
        if (changes.empty()) return text[at] == '{' ? "{}" : "[]";
        size_t close = 0;
        const std::vector<Part> parts = parts_of(text, at, close);
        const std::string indent = indent_at(text, at);
        const std::string lead = parts.empty() ? (style.lines ? style.newline + indent + style.unit : "")
                                               : std::string(between(at + 1, parts[0].begin));
        const bool lines = lead.find('\n') != std::string::npos;
        const std::string inner = lines ? after_last_newline(lead) : indent;
        const std::string separator =
            parts.size() > 1 ? std::string(between(parts[parts.size() - 2].end, parts.back().begin)) : "," + lead;

        std::string out = text[at] + lead;
        size_t before = kNew;  // old_index of the change written last
        for (const Change& change : changes) {
            const size_t i = change.old_index;
            if (&change != changes.data())
                out += i != kNew && i > 0 && before != kNew ? between(parts[i - 1].end, parts[i].begin) : separator;
            if (i != kNew) {
                out += between(parts[i].begin, parts[i].value);
                out += value(parts[i].value, *change.old_value, *change.new_value, lines, inner);
            } else {
                out += new_part(change, parts, lines, inner);
            }
            before = i;
        }
        out += parts.empty() ? (lines ? style.newline + indent : "") : std::string(between(parts.back().end, close));
        return out + text[close];
    }

    std::string new_part(const Change& change, const std::vector<Part>& parts, bool lines,
                         const std::string& indent) const {
        if (change.copy_of != kNew) return std::string(between(parts[change.copy_of].value, parts[change.copy_of].end));
        const std::string key = change.key.data() ? ordered_json(change.key).dump() + style.colon : "";
        return key + laid_out(*change.new_value, style, lines, indent);
    }
};

size_t root_of(std::string_view text) {
    return skip_space(text, text.starts_with("\xef\xbb\xbf") ? 3 : 0);
}

}  // namespace

void expect_shallow_json(std::string_view text, const std::string& file) {
    int depth = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"') {
            for (++i; i < text.size() && text[i] != '"'; ++i)
                if (text[i] == '\\') ++i;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaxJsonNesting)
                throw InputError(file, "", fmt::format("JSON nests deeper than {} levels", kMaxJsonNesting));
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

void refuse_json(const std::string& file, std::string_view message) {
    const size_t code_end = message.find("] ");  // "[json.exception.…] what is wrong"
    const size_t begin = code_end == std::string_view::npos ? 0 : code_end + 2;
    throw InputError(file, "", fmt::format("JSON: {}", message.substr(begin, 2 * kMaxQuoted)),
                     "write it as JSON in UTF-8");
}

ordered_json parse_document(std::string_view text, const std::string& file) {
    expect_shallow_json(text, file);
    std::vector<std::set<std::string>> keys(kMaxJsonNesting + 2);  // of the open object at each depth
    const auto check = [&](int depth, ordered_json::parse_event_t event, ordered_json& parsed) {
        const auto level = static_cast<size_t>(depth);
        if (event == ordered_json::parse_event_t::object_start) keys[level + 1].clear();
        if (event != ordered_json::parse_event_t::key) return true;
        const auto& key = parsed.get_ref<const std::string&>();
        if (!keys[level].insert(key).second)
            throw InputError(file, "", fmt::format("has the member \"{}\" of one object twice", key),
                             "keep one of them");
        if (keys[level].size() > kMaxJsonMembers)
            throw InputError(file, "", fmt::format("has an object of more than {} members", kMaxJsonMembers));
        return true;
    };
    try {
        return ordered_json::parse(text, check);
    } catch (const ordered_json::exception& error) {
        refuse_json(file, error.what());
    }
}

std::string spliced(std::string_view text, const ordered_json& original, const ordered_json& edited) {
    if (original == edited) return std::string(text);
    const size_t root = root_of(text);
    const Splicer splicer{text, style_of(text, root)};
    std::string out(text.substr(0, root));
    out += splicer.value(root, original, edited, splicer.style.lines, "");
    return out += text.substr(value_end(text, root));
}

std::string spliced(std::string_view text, const StageJson& original, const StageJson& edited) {
    if (original == edited) return std::string(text);
    const size_t root = root_of(text);
    const Splicer splicer{text, style_of(text, root)};
    std::string out(text.substr(0, root));
    out += splicer.container(root, changes_of_object(original.members(), edited.members()));
    return out += text.substr(value_end(text, root));
}

}  // namespace neuvv::stage
