// What errors of the library say on the command line, and that the library itself knows of none.
#include "tools/remedies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "base/platform.h"

namespace neuvv {
namespace {

// The string literals of a C++ source, whose comments begin with two slashes.
std::vector<std::string> literals_of(const std::string& source) {
    std::vector<std::string> literals;
    for (size_t i = 0; i < source.size(); ++i) {
        const char c = source[i];
        if (c == '/' && source.compare(i, 2, "//") == 0) i = std::min(source.find('\n', i), source.size());
        const bool separates_digits = c == '\'' && i > 0 && std::isxdigit(static_cast<unsigned char>(source[i - 1]));
        if ((c != '"' && c != '\'') || separates_digits) continue;
        const bool raw = c == '"' && i > 0 && source[i - 1] == 'R';
        const size_t begin = i + 1;
        if (raw) {
            const std::string end = ")" + source.substr(begin, source.find('(', begin) - begin) + "\"";
            i = source.find(end, begin) + end.size() - 1;
        } else {
            for (++i; i < source.size() && source[i] != c; ++i)
                if (source[i] == '\\') ++i;
        }
        if (c == '"') literals.push_back(source.substr(begin, i - begin));
    }
    return literals;
}

// Whether a text names an option, or a verb of the program.
bool names_command_line(const std::string& text) {
    if (text.find("`neuvv ") != std::string::npos) return true;
    for (size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at + 1)) {
        const bool begins = at == 0 || text[at - 1] == ' ' || text[at - 1] == '(' || text[at - 1] == '`';
        if (begins && at + 2 < text.size() && std::islower(static_cast<unsigned char>(text[at + 2]))) return true;
    }
    return false;
}

std::string text_of(const std::filesystem::path& file) {
    const std::vector<uint8_t> bytes = read_file(file);
    return {bytes.begin(), bytes.end()};
}

TEST(Remedies, AreSaidByOptionsOnTheCommandLineAlone) {
    const RuntimeFailure failure("too many leaves", Remedy::kFewerLeaves);
    EXPECT_STREQ(failure.what(), "too many leaves; choose a clip of fewer leaves, a smaller image, or another device");
    EXPECT_EQ(tools::message_of(failure),
              "too many leaves; choose a clip of fewer leaves (--max-leaves of `neuvv train`), a smaller --size, or "
              "another device (`neuvv devices` lists them)");
    const InputError setting(Setting{"fps"}, "", "is 0", "choose 25");
    EXPECT_STREQ(setting.what(), "fps: is 0; choose 25");
    EXPECT_EQ(tools::message_of(setting), "--fps: is 0; choose 25");
    const InputError file("a.nvv", "chunk run0", "is missing", {Remedy::kMakeMattes, "the\nfolder"});
    EXPECT_STREQ(file.what(), "a.nvv: chunk run0: is missing; make mattes for the folder");
    EXPECT_EQ(tools::message_of(file), "a.nvv: chunk run0: is missing; run `neuvv matte the folder`");
    EXPECT_EQ(tools::message_of(InputError("a.nvv", "", "is odd")), "a.nvv: is odd");
    EXPECT_EQ(tools::message_of(std::runtime_error("no memory")), "no memory");
    EXPECT_EQ(tools::message_of(Note("it lies", {Remedy::kUpIfTrue, "z"})), "it lies; --up=z if that axis is up");
}

TEST(Remedies, ThatNoOptionIsPartOfAreSaidAlike) {
    for (size_t i = 1; i < static_cast<size_t>(Remedy::kCount); ++i) {
        const Fix fix(static_cast<Remedy>(i), "VALUE");
        const std::string plain = plain_words(fix), said = tools::message_of(Note("cause", fix)).substr(7);
        EXPECT_FALSE(plain.empty()) << i;
        EXPECT_FALSE(names_command_line(plain)) << plain;
        EXPECT_EQ(plain.find("VALUE") == std::string::npos, said.find("VALUE") == std::string::npos) << said;
        EXPECT_TRUE(said == plain || names_command_line(said)) << said;
    }
}

TEST(Library, NamesNoOptionAndNoVerb) {
    EXPECT_EQ(literals_of("f(\"a\", '\"', 1'000, \"b\\\"c\"); // \"d\"\nR\"(e\"f)\" \"g\""),
              (std::vector<std::string>{"a", "b\\\"c", "(e\"f)", "g"}));
    for (const char* text : {"--size", "a smaller --size", "(--max-leaves 3)", "`neuvv devices` lists them"})
        EXPECT_TRUE(names_command_line(text)) << text;
    for (const char* text : {"a - b", "a--b", "x -- y", "the neuvv that wrote it"})
        EXPECT_FALSE(names_command_line(text)) << text;
    // Of other programs.
    const std::vector<std::string> allowed = {"--quiet", "--target-env",
                                              "references are not followed: flatten it with usdcat --flatten"};
    size_t files = 0;
    for (const char* module : {"engine", "training", "xr"})
        for (const auto& entry :
             std::filesystem::recursive_directory_iterator(std::filesystem::path(NEUVV_SOURCE_DIR) / module)) {
            const std::filesystem::path ending = entry.path().extension();
            if (ending != ".h" && ending != ".cpp") continue;
            ++files;
            for (const std::string& text : literals_of(text_of(entry.path())))
                if (names_command_line(text) && std::ranges::find(allowed, text) == allowed.end())
                    ADD_FAILURE() << entry.path().string() << ": \"" << text
                                  << "\"; the library says remedies as data (engine/base/remedy.h)";
        }
    EXPECT_GT(files, 500u);
}

}  // namespace
}  // namespace neuvv
