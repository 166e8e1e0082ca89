#include "tools/paint_layers.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "base/error.h"
#include "voctree/nvpaint.h"

namespace neuvv::tools {

namespace {

std::optional<stage::PaintBlend> blend_of(const std::string& name) {
    for (size_t i = 0; i < std::size(stage::kPaintBlendNames); i++)
        if (name == stage::kPaintBlendNames[i]) return static_cast<stage::PaintBlend>(i);
    return std::nullopt;
}

std::optional<float> opacity_of(const std::string& text) {
    float value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= 0 && value <= 1)) return std::nullopt;
    return value;
}

// A name that is no file but for what stands behind its last colon: that is meant as a blend, or as an opacity.
void expect_blend_or_opacity(const std::string& name, const std::string& last) {
    std::error_code error;
    const bool names_layer = name.find(".nvpaint:") != std::string::npos ||
                             std::filesystem::exists(name.substr(0, name.size() - last.size() - 1), error);
    if (!names_layer || std::filesystem::exists(name, error)) return;
    double number = 0;
    const auto [end, problem] = std::from_chars(last.data(), last.data() + last.size(), number);
    if (problem != std::errc::invalid_argument && end == last.data() + last.size())
        throw InputError("--paint", name, fmt::format("{} is no opacity", last), "write 0 to 1");
    parse_blend("--paint", last);
}

// Takes what stands behind the last colon off, which a file's name may have, too.
std::optional<std::string> last_part(const std::string& text) {
    const size_t colon = text.rfind(':');
    if (colon == std::string::npos) return std::nullopt;
    return text.substr(colon + 1);
}

}  // namespace

stage::PaintBlend parse_blend(const std::string& option, const std::string& text) {
    if (const auto blend = blend_of(text)) return *blend;
    throw InputError(option, "", fmt::format("there is no blend `{}`", text),
                     "write normal, multiply, tint or recolour");
}

PaintStack read_paint_stack(const std::vector<std::string>& names, const voctree::PaintedField& field) {
    PaintStack stack;
    for (std::string file : names) {
        render::PaintUse use;
        const auto last = last_part(file);
        if (const auto opacity = last ? opacity_of(*last) : std::nullopt) {
            file.resize(file.size() - last->size() - 1);
            use.opacity = *opacity;
            const auto blend = last_part(file);
            if (!blend) throw InputError("--paint", file, "has an opacity but no blend", "write FILE:normal:0.5");
            use.blend = parse_blend("--paint", *blend);
            file.resize(file.size() - blend->size() - 1);
        } else if (last) {
            expect_blend_or_opacity(file, *last);
            if (const auto blend = blend_of(*last)) {
                use.blend = *blend;
                file.resize(file.size() - last->size() - 1);
            }
        }
        stack.layers.push_back(voctree::read_paint(file, field));
        stack.uses.push_back(use);
        stack.files.push_back(file);
    }
    for (size_t i = 0; i < stack.uses.size(); i++) stack.uses[i].layer = &stack.layers[i];
    return stack;
}

}  // namespace neuvv::tools
