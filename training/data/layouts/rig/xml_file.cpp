#include "training/data/layouts/rig/xml_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxXmlBytes = uint64_t{64} << 20;  // Metashape writes some kilobytes a camera

// The finite number at the beginning of the text; moves the text behind it.
std::optional<double> take_number(std::string_view& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return {};
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    return value;
}

void skip_spaces(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

}  // namespace

std::string XmlNode::place() const {
    return fmt::format("{:.80}, line {}", element->Name(), element->GetLineNum());
}

void XmlNode::fail(const std::string& problem, const std::string& fix) const {
    throw InputError(file, place(), problem, fix);
}

std::optional<XmlNode> XmlNode::find(const char* child) const {
    const tinyxml2::XMLElement* found = element->FirstChildElement(child);
    if (!found) return {};
    return XmlNode{found, file};
}

XmlNode XmlNode::child(const char* name) const {
    const std::optional<XmlNode> found = find(name);
    if (!found) fail(fmt::format("has no {}", name));
    return {found->element, file};
}

std::vector<XmlNode> XmlNode::children(const char* name) const {
    std::vector<XmlNode> result;
    for (const auto* at = element->FirstChildElement(name); at; at = at->NextSiblingElement(name))
        result.push_back({at, file});
    return result;
}

bool XmlNode::has(const char* attribute) const {
    return element->FindAttribute(attribute) != nullptr;
}

std::string XmlNode::text(const char* attribute, const std::string& fallback) const {
    const char* found = element->Attribute(attribute);
    return found ? found : fallback;
}

double XmlNode::number(const char* attribute) const {
    const char* found = element->Attribute(attribute);
    if (!found) fail(fmt::format("has no {}", attribute));
    std::string_view rest = found;
    skip_spaces(rest);
    const std::optional<double> value = take_number(rest);
    skip_spaces(rest);
    if (!value || !rest.empty()) fail(fmt::format("has a {} that is no number: {:.40}", attribute, found));
    return *value;
}

double XmlNode::number(const char* attribute, double fallback) const {
    return has(attribute) ? number(attribute) : fallback;
}

std::vector<double> XmlNode::numbers(size_t count) const {
    const char* content = element->GetText();
    std::string_view rest = content ? content : "";
    std::vector<double> values;
    for (skip_spaces(rest); !rest.empty() && values.size() <= count; skip_spaces(rest)) {
        const std::optional<double> value = take_number(rest);
        if (!value) fail(fmt::format("is not {} numbers", count));
        values.push_back(*value);
    }
    if (values.size() != count) fail(fmt::format("is not {} numbers", count));
    return values;
}

XmlFile::XmlFile(const std::filesystem::path& file) : file_(file.string()) {
    const std::vector<uint8_t> bytes = read_file(file, kMaxXmlBytes);
    document_.Parse(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (document_.Error())
        throw InputError(file_, fmt::format("line {}", document_.ErrorLineNum()),
                         fmt::format("is no XML: {}", tinyxml2::XMLDocument::ErrorIDToName(document_.ErrorID())), "");
    if (!document_.RootElement()) throw InputError(file_, "", "is an XML file without an element");
}

XmlNode XmlFile::root() const {
    return {document_.RootElement(), file_};
}

}  // namespace neuvv::training
