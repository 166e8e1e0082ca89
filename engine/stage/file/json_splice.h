// Applies edits of a parsed JSON document to its text: what was not edited keeps its bytes.
//
// Parsing loses how a text was written: numbers as they were typed (1.0, 1e-3), white space, escapes. So an edited
// document is not serialised as a whole. It is compared with the document that the text was parsed to, and only values
// that differ are replaced in the text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "stage/file/stage_json.h"

namespace neuvv::stage {

// Limits on a document: how deep its values nest, and how many members an object has.
constexpr int kMaxJsonNesting = 64;
constexpr size_t kMaxJsonMembers = 4096;

// Throws InputError naming `file` where the text nests deeper than kMaxJsonNesting. To be called before a parser, which
// recurses as deep as the text nests.
void expect_shallow_json(std::string_view text, const std::string& file);

// Throws InputError of what nlohmann's parser says is wrong with a document: its first words, as it may quote a whole
// document.
[[noreturn]] void refuse_json(const std::string& file, std::string_view message);

// Parses a document. Throws InputError naming `file` where the text is not JSON or not UTF-8, nests too deep, has an
// object of too many members, or has a member of one object twice, where programs differ in which of the two they take.
nlohmann::ordered_json parse_document(std::string_view text, const std::string& file);

// Changes `text`, which parses to `original`, so that it parses to `edited`, and returns it. New members and elements
// are laid out as their neighbours are. Members keep the order of the text, and new ones come last in their object;
// list elements are matched so that few values differ.
std::string spliced(std::string_view text, const nlohmann::ordered_json& original,
                    const nlohmann::ordered_json& edited);
// The same for StageJson; members that both documents share are not compared.
std::string spliced(std::string_view text, const StageJson& original, const StageJson& edited);

}  // namespace neuvv::stage
