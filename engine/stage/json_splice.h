// JSON text in, edited JSON text out: what was not edited stays as it was written, byte for byte.
//
// A document of another program says things that a parsed copy loses: numbers as they were typed (1.0, 1e-3), white
// space, escapes. So an edit is not written from the copy: the copy is compared with what the text says, and only the
// values that differ are cut out of the text and replaced.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "stage/stage_json.h"

namespace neuvv::stage {

// One value nests at most so deep, an object has at most so many members.
constexpr int kMaxJsonNesting = 64;
constexpr size_t kMaxJsonMembers = 4096;

// Before a parser, which is as deep as the text. Throws InputError naming `file`.
void expect_shallow_json(std::string_view text, const std::string& file);

// What the text says. Throws InputError naming `file` for what is no JSON, no UTF-8, nests too deep or says one member
// twice, of which programs take either.
nlohmann::ordered_json parse_document(std::string_view text, const std::string& file);

// `text`, which says `original` (parse_document), changed to say `edited`. New members and elements are laid out as
// their neighbours are, and go last in their object; list elements are matched so that few values differ. Order of
// members is the text's.
std::string spliced(std::string_view text, const nlohmann::ordered_json& original,
                    const nlohmann::ordered_json& edited);
// The same of a document; members that both share are not looked at.
std::string spliced(std::string_view text, const StageJson& original, const StageJson& edited);

}  // namespace neuvv::stage
