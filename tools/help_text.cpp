#include "tools/help_text.h"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "base/text.h"

namespace neuvv::tools {

namespace {

// Columns that UTF-8 text takes, of letters that take one each.
size_t columns_of(const std::string& text) {
    return static_cast<size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::vector<std::string> words_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

// The words of a command, each option with its value as one.
std::vector<std::string> command_words(const std::string& command) {
    std::vector<std::string> parts;
    for (const std::string& word : words_of(command)) {
        const bool is_value = !parts.empty() && parts.back()[0] == '-' && word[0] != '-';
        if (is_value && parts.back().find(' ') == std::string::npos)
            parts.back() += " " + word;
        else
            parts.push_back(word);
    }
    return parts;
}

// The words in lines. The first one begins with `first`, which is not broken, the others with `indent` spaces; each but
// the last ends with `ending`.
std::string lines_of(const std::string& first, const std::vector<std::string>& words, size_t indent,
                     const std::string& ending = "") {
    std::string lines, line = first;
    bool is_begun = false;
    for (const std::string& word : words) {
        const size_t columns = columns_of(line) + columns_of(word) + (is_begun ? 1 : 0) + ending.size();
        if (is_begun && columns > kHelpColumns) {
            lines += line + ending + "\n";
            line = std::string(indent, ' ');
            is_begun = false;
        }
        line += (is_begun ? " " : "") + word;
        is_begun = true;
    }
    return lines + line + "\n";
}

std::string indented_line(const std::string& line) {
    if (columns_of(line) <= kHelpColumns) return line + "\n";
    const size_t begin = line.find_first_not_of(' ');
    const size_t gap = line.find("  ", begin);
    if (gap == std::string::npos)
        return lines_of(std::string(begin, ' '), command_words(line.substr(begin)), begin + 4, " \\");
    const size_t column = line.find_first_not_of(' ', gap);
    return lines_of(line.substr(0, column), words_of(line.substr(column)), columns_of(line.substr(0, column)));
}

// Letters that have to be put in, left out, replaced or exchanged with their neighbour.
size_t distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<size_t>> of(a.size() + 1, std::vector<size_t>(b.size() + 1));
    for (size_t i = 0; i <= a.size(); ++i) of[i][0] = i;
    std::iota(of[0].begin(), of[0].end(), size_t{0});
    for (size_t i = 1; i <= a.size(); ++i)
        for (size_t j = 1; j <= b.size(); ++j) {
            of[i][j] = std::min({of[i - 1][j] + 1, of[i][j - 1] + 1, of[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                of[i][j] = std::min(of[i][j], of[i - 2][j - 2] + 1);
        }
    return of[a.size()][b.size()];
}

// A list of values with spaces behind its commas, where lines may end.
std::string with_breaks(const std::string& name) {
    std::string broken;
    for (const char c : name) broken += c == ',' ? ", " : std::string(1, c);
    return broken;
}

}  // namespace

std::string help_entry(const std::string& name, const std::string& description, size_t column) {
    std::string entry = "  " + name, above;
    if (description.empty() || columns_of(entry) + 2 > column) {
        above = lines_of("  ", words_of(columns_of(entry) > kHelpColumns ? with_breaks(name) : name), 4);
        entry.clear();
    }
    if (description.empty()) return above;
    entry += std::string(column - columns_of(entry), ' ');
    return above + lines_of(entry, words_of(description), column);
}

std::string filled(const std::string& text) {
    std::istringstream lines(text);
    std::string all, paragraph;
    const auto end_paragraph = [&] {
        if (!paragraph.empty()) all += lines_of("", words_of(paragraph), 0);
        paragraph.clear();
    };
    for (std::string line; std::getline(lines, line);) {
        const bool is_row = line.empty() || line[0] == ' ' || line.find("  ") != std::string::npos;  // of a table
        if (is_row) {
            end_paragraph();
            all += line.empty() ? "\n" : indented_line(line);
            continue;
        }
        paragraph += line + " ";
        if (line.ends_with(':') || line.ends_with('.')) end_paragraph();
    }
    end_paragraph();
    return all;
}

std::string nearest_name(const std::string& typed, const std::vector<std::string>& names) {
    std::string nearest;
    size_t least = std::max<size_t>(1, typed.size() / 3) + 1;
    for (const std::string& name : names) {
        // One begins with the other, as in "dev" for "devices".
        const std::string short_one = std::min(typed, name, [](auto& a, auto& b) { return a.size() < b.size(); });
        const bool begins = short_one.size() >= 3 && name.starts_with(short_one) && typed.starts_with(short_one);
        const size_t away = begins ? 1 : distance(lower_case(typed), lower_case(name));
        if (away >= least || away >= name.size()) continue;
        least = away;
        nearest = name;
    }
    return nearest;
}

}  // namespace neuvv::tools
