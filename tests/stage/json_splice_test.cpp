#include "stage/file/json_splice.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <random>

#include "support/input_error.h"

namespace neuvv {
namespace {

using nlohmann::ordered_json;

std::string edited(const std::string& text, const std::function<void(ordered_json&)>& edit) {
    const ordered_json original = stage::parse_document(text, "file");
    ordered_json changed = original;
    edit(changed);
    const std::string result = stage::spliced(text, original, changed);
    EXPECT_EQ(nlohmann::json::parse(result), nlohmann::json(changed)) << result;
    return result;
}

TEST(JsonSplice, OneNumberChangesAndNothingElse) {
    const std::string text = "\xef\xbb\xbf {\r\n\t\"a\" : 1.0,\"b\":[1e-3,  -0, 2.50 ],\r\n \"\\u0063\" : \"\\/\"}\n\n";
    EXPECT_EQ(edited(text, [](ordered_json& json) { json["b"][1] = 7; }),
              "\xef\xbb\xbf {\r\n\t\"a\" : 1.0,\"b\":[1e-3,  7, 2.50 ],\r\n \"\\u0063\" : \"\\/\"}\n\n");
    EXPECT_EQ(edited(text, [](ordered_json& json) { json["c"] = "/"; }), text) << "the same value said anew";
    EXPECT_EQ(edited(text, [](ordered_json& json) { json["a"] = 1; }), text) << "1.0 is 1";
}

TEST(JsonSplice, NewMembersLookLikeTheirNeighbours) {
    const std::string text = "{\n    \"nodes\": [\n        {\n            \"name\": \"a\"\n        }\n    ]\n}\n";
    EXPECT_EQ(
        edited(text,
               [](ordered_json& json) {
                   json["nodes"].push_back({{"name", "b"}, {"scale", {1, 2, 3}}});
               }),
        "{\n    \"nodes\": [\n        {\n            \"name\": \"a\"\n        },\n        {\n            \"name\": "
        "\"b\",\n            \"scale\": [1, 2, 3]\n        }\n    ]\n}\n");
    EXPECT_EQ(edited(text, [](ordered_json& json) { json["scene"] = 0; }).substr(text.size() - 3),
              ",\n    \"scene\": 0\n}\n");
    EXPECT_EQ(edited("{\"a\":[1,2],\"b\":{}}",
                     [](ordered_json& json) {
                         json["a"].push_back(3);
                         json["b"]["c"] = {{"d", true}};
                     }),
              "{\"a\":[1,2,3],\"b\":{\"c\":{\"d\":true}}}");
}

TEST(JsonSplice, WhatIsRemovedTakesItsCommaAlong) {
    const std::string text = "{ \"a\": 1,  \"b\": 2,   \"c\": [10, 20.0, 30] }";
    EXPECT_EQ(edited(text, [](ordered_json& json) { json.erase("a"); }), "{ \"b\": 2,   \"c\": [10, 20.0, 30] }");
    EXPECT_EQ(edited(text, [](ordered_json& json) { json.erase("b"); }), "{ \"a\": 1,   \"c\": [10, 20.0, 30] }");
    EXPECT_EQ(edited(text, [](ordered_json& json) { json["c"].erase(0); }),
              "{ \"a\": 1,  \"b\": 2,   \"c\": [20.0, 30] }");
    EXPECT_EQ(edited(text, [](ordered_json& json) { json["c"].clear(); }), "{ \"a\": 1,  \"b\": 2,   \"c\": [] }");
    EXPECT_EQ(edited("{\"a\":1}", [](ordered_json& json) { json.clear(); }), "{}");
}

// Where an element is removed and another changes, the text of the third stays.
TEST(JsonSplice, ListElementsAreMatchedByWhatTheyAre) {
    const std::string text = R"([{"n":1.0,"c":[3]}, {"n":2.0}, {"n":3.0,"x":1e0}, {"n":4.0,"c":[2]}])";
    EXPECT_EQ(edited(text,
                     [](ordered_json& json) {
                         json.erase(1);
                         json[0]["c"] = {2};
                         json[2]["c"] = {1};
                     }),
              R"([{"n":1.0,"c":[2]}, {"n":3.0,"x":1e0}, {"n":4.0,"c":[1]}])");
    EXPECT_EQ(
        edited(R"([ {"a": 1.00}, {"b": 2.00} ,{"c":3}])", [](ordered_json& json) { std::swap(json[0], json[1]); }),
        R"([ {"b":2.0}, {"a":1.0} ,{"c":3}])")
        << "as many as before: each is what stands in its place";
    EXPECT_EQ(edited(R"([{"a": 1.00}, {"b": 2.00}])",
                     [](ordered_json& json) { json.insert(json.begin(), ordered_json::parse(R"({"z":1})")); }),
              R"([{"z":1}, {"a": 1.00}, {"b": 2.00}])");
}

// Random documents with random layouts are edited at random: the result parses to the edited document, and every part
// of the top level that was not edited keeps its bytes.
struct Shuffle {
    std::mt19937 random{7};
    int below(int end) { return static_cast<int>(random() % static_cast<unsigned>(end)); }
    std::string space() {
        const char* const kSpaces[] = {"", "", " ", "\n  ", "\t", "\r\n"};
        return kSpaces[below(6)];
    }
    std::string text(int depth) {
        const char* const kPlain[] = {
            "1.0", "-0", "1e-3", "\"a,]}\\\"\"", "true", "null", "12345678901234567890123", "\"\\u00e9\""};
        const int kind = depth == 0 ? 0 : below(3);
        if (kind == 0) return kPlain[below(8)];
        std::string out = kind == 1 ? "[" : "{";
        const int parts = below(5);
        for (int i = 0; i < parts; ++i) {
            out += (i ? "," : "") + space();
            if (kind == 2) out += "\"k" + std::to_string(i) + "\"" + space() + ":" + space();
            out += text(depth - 1) + space();
        }
        return out + space() + (kind == 1 ? "]" : "}");
    }
    void edit(ordered_json& json, int depth) {
        const int what = below(6);
        if (depth > 0 && json.is_structured() && !json.empty() && what < 3) {
            auto part = json.begin();
            std::advance(part, below(static_cast<int>(json.size())));
            return edit(*part, depth - 1);
        }
        if (json.is_array() && what == 3) return json.push_back({{"new", below(9)}});
        if (json.is_array() && what == 4 && !json.empty()) {
            json.erase(static_cast<size_t>(below(static_cast<int>(json.size()))));
            return;
        }
        if (json.is_object() && what == 3) {
            json["new" + std::to_string(below(9))] = {1, {{"x", 2.5}}};
            return;
        }
        if (json.is_object() && what == 4 && !json.empty()) {
            json.erase(json.begin());
            return;
        }
        json = below(100);
    }
};

TEST(JsonSplice, RandomEditsOfRandomDocuments) {
    Shuffle shuffle;
    for (int round = 0; round < 4000; ++round) {
        const std::string text = shuffle.space() + "{\"keep\" :" + shuffle.text(3) + shuffle.space() +
                                 ",\"x\":" + shuffle.text(4) + shuffle.space() + ", \"last\" : " + shuffle.text(3) +
                                 "}" + shuffle.space();
        const ordered_json original = stage::parse_document(text, "file");
        EXPECT_EQ(stage::spliced(text, original, original), text);
        const std::string result = edited(text, [&](ordered_json& json) {
            for (int i = shuffle.below(3); i >= 0; --i) shuffle.edit(json["x"], 4);
        });
        const size_t x = text.find(",\"x\":"), last = text.rfind(", \"last\" : ");
        EXPECT_EQ(result.substr(0, x), text.substr(0, x));
        EXPECT_TRUE(result.ends_with(text.substr(last))) << text << "\n" << result;
    }
}

TEST(JsonSplice, WhatMayBeReadInTwoWaysIsRefused) {
    const auto refused = [](const std::string& text, std::initializer_list<std::string> parts) {
        expect_input_error([&] { stage::parse_document(text, "my.gltf"); }, parts);
    };
    refused(R"({"a":1,"b":{"c":1,"c":2}})", {"my.gltf", "\"c\"", "twice"});
    refused("{\"a\":\"\xff\"}", {"my.gltf", "UTF-8"});
    refused(R"({"a":1)", {"my.gltf", "JSON: parse error at line 1"});
    refused("", {"my.gltf"});
    refused(R"({"a":1e999})", {"my.gltf"});
    refused(std::string(100000, '['), {"my.gltf", "deeper"});
    const std::string cut_off = "{\"a\":\"" + std::string(100000, 'A');  // as an embedded buffer may be
    try {
        stage::parse_document(cut_off, "my.gltf");
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_LT(std::string(error.what()).size(), 400u);
    }
    EXPECT_NO_THROW(stage::parse_document(R"([{"a":1},{"a":2,"b":{"a":3}}])", "f"));
}

}  // namespace
}  // namespace neuvv
