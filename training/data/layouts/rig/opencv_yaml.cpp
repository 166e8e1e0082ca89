#include "training/data/layouts/rig/opencv_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxYamlBytes = uint64_t{4} << 20;  // about 4,000 cameras; the parser takes 2 s for so many

std::string place_of(const std::string& key, const YAML::Node& node) {
    return fmt::format("{:.80}, line {}", key, node.Mark().line + 1);
}

double finite_number(const std::string& file, const std::string& key, const YAML::Node& node) {
    double value = NAN;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value))
        throw InputError(file, place_of(key, node), "is no number", "");
    return value;
}

}  // namespace

OpencvYaml::OpencvYaml(const std::filesystem::path& file) : file_(file.string()) {
    const std::vector<uint8_t> bytes = read_file(file, kMaxYamlBytes);
    try {
        const YAML::Node root = YAML::Load(std::string(bytes.begin(), bytes.end()));
        if (!root.IsMap()) throw InputError(file_, "", "is no OpenCV YAML file", "it begins with %YAML:1.0");
        for (const auto& entry : root) values_[entry.first.Scalar()] = entry.second;
    } catch (const YAML::Exception& error) {
        const bool placed = !error.mark.is_null();
        throw InputError(file_, placed ? fmt::format("line {}", error.mark.line + 1) : "",
                         fmt::format("is no YAML: {:.200}", error.msg), "");
    }
}

bool OpencvYaml::has(const std::string& key) const {
    return values_.contains(key);
}

YAML::Node OpencvYaml::find(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? YAML::Node(YAML::NodeType::Undefined) : found->second;
}

std::vector<std::string> OpencvYaml::names(const std::string& key) const {
    const YAML::Node list = find(key);
    if (!list.IsDefined()) throw InputError(file_, key, "is missing", "list the cameras' names there");
    if (!list.IsSequence() || list.size() == 0) throw InputError(file_, place_of(key, list), "is no list of names", "");
    std::vector<std::string> names;
    for (const YAML::Node& name : list) {
        if (!name.IsScalar()) throw InputError(file_, place_of(key, name), "is no name", "");
        names.push_back(name.Scalar());
    }
    return names;
}

std::optional<double> OpencvYaml::number(const std::string& key) const {
    const YAML::Node node = find(key);
    if (!node.IsDefined()) return {};
    return finite_number(file_, key, node);
}

std::string OpencvYaml::text(const std::string& key) const {
    const YAML::Node node = find(key);
    if (!node.IsDefined()) throw InputError(file_, key, "is missing");
    if (!node.IsScalar()) throw InputError(file_, place_of(key, node), "is no text");
    return node.Scalar();
}

std::optional<std::vector<double>> OpencvYaml::matrix(const std::string& key,
                                                      std::initializer_list<size_t> sizes) const {
    const YAML::Node node = find(key);
    if (!node.IsDefined()) return {};
    const auto fail = [&](const std::string& problem) {
        throw InputError(file_, place_of(key, node), problem, "write it as OpenCV's FileStorage does");
    };
    if (!node.IsMap() || !node["rows"] || !node["cols"] || !node["data"] || !node["data"].IsSequence())
        fail("is no matrix with rows, cols and data");
    const double rows = finite_number(file_, key, node["rows"]), columns = finite_number(file_, key, node["cols"]);
    const size_t size = node["data"].size();
    if (rows * columns != static_cast<double>(size))
        fail(fmt::format("says {} rows of {}, but has {} numbers", rows, columns, size));
    if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) fail(fmt::format("has {} numbers", size));
    std::vector<double> values;
    for (const YAML::Node& value : node["data"]) values.push_back(finite_number(file_, key, value));
    return values;
}

}  // namespace neuvv::training
