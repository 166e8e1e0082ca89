// Reads the part of OpenCV's YAML 1.0 that calibrations use: names, numbers, matrices.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace neuvv::training {

// All functions that read throw InputError with file, key and line.
class OpencvYaml {
  public:
    explicit OpencvYaml(const std::filesystem::path& file);

    const std::string& file() const { return file_; }
    bool has(const std::string& key) const;
    // A list of strings, at least one. Throws where it is missing.
    std::vector<std::string> names(const std::string& key) const;
    std::optional<double> number(const std::string& key) const;
    std::string text(const std::string& key) const;  // throws where it is missing or no scalar
    // The numbers of a matrix, row by row, all finite; nothing where the key is missing. Throws where their count is
    // none of `sizes`.
    std::optional<std::vector<double>> matrix(const std::string& key, std::initializer_list<size_t> sizes) const;

  private:
    YAML::Node find(const std::string& key) const;

    std::string file_;
    std::map<std::string, YAML::Node> values_;
};

}  // namespace neuvv::training
