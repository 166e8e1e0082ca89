// XML that other programs wrote: elements together with their place in the file, so that errors can say where a problem
// is.
#pragma once

#include <tinyxml2.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace neuvv::training {

// An element. It refers to the document and to the file's name, which must outlive it. Functions that read throw
// InputError with file, element and line.
struct XmlNode {
    const tinyxml2::XMLElement* element;
    const std::string& file;

    std::string place() const;  // "camera, line 12"
    [[noreturn]] void fail(const std::string& problem, const std::string& fix = "") const;

    std::optional<XmlNode> find(const char* child) const;   // the first element of this name
    XmlNode child(const char* name) const;                  // throws where it is missing
    std::vector<XmlNode> children(const char* name) const;  // may be empty
    bool has(const char* attribute) const;
    // The attribute's text, or `fallback` where it is missing.
    std::string text(const char* attribute, const std::string& fallback = "") const;
    double number(const char* attribute) const;  // finite; throws where it is missing
    double number(const char* attribute, double fallback) const;
    // The numbers of the element's content, separated by spaces; all are finite. Throws where there are not `count`.
    std::vector<double> numbers(size_t count) const;
};

class XmlFile {
  public:
    // Throws InputError where the file is no XML or has no element.
    explicit XmlFile(const std::filesystem::path& file);
    XmlNode root() const;

  private:
    std::string file_;
    tinyxml2::XMLDocument document_;
};

}  // namespace neuvv::training
