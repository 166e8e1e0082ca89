// OpenUSD's text files, .usda: prims with their attributes, as plain data. Compositions (references, payloads, layers,
// variants) are not followed, and values that are dictionaries are skipped.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace neuvv::interchange {

// A value of any type, with brackets left out: ((1, 2), (3, 4)) has four numbers. Texts are strings, tokens, paths of
// prims and of files, in the order in which they stand.
struct UsdValue {
    std::vector<double> numbers;
    std::vector<std::string> texts;
};

struct UsdAttribute {
    std::string type;                                  // as it is written: "double3", "token[]"; of relationships "rel"
    UsdValue value;                                    // empty where there is none
    std::vector<std::pair<double, UsdValue>> samples;  // by time code, ascending
};

struct UsdPrim {
    std::string specifier, type, name;  // specifier: def, over or class; the type may be empty
    std::map<std::string, UsdValue> metadata;
    std::map<std::string, UsdAttribute> attributes;
    std::vector<UsdPrim> children;
};

struct UsdLayer {
    std::map<std::string, UsdValue> metadata;
    std::vector<UsdPrim> prims;

    // The first number or text of a layer's metadata.
    double number(const std::string& name, double fallback) const;
    std::string text(const std::string& name, const std::string& fallback) const;
};

// Throws InputError with the line where the text is no .usda, and for binary files (.usdc), naming how to make a .usda
// of them.
UsdLayer read_usda(const std::filesystem::path& file);

}  // namespace neuvv::interchange
