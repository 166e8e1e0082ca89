// Layers of paint as the command line names them.
#pragma once

#include <string>
#include <vector>

#include "render/paint.h"

namespace neuvv::tools {

// Layers that are read, and how they show.
struct PaintStack {
    std::vector<voctree::EditLayer> layers;
    std::vector<render::PaintUse> uses;  // of them, the lowest first
    std::vector<std::string> files;
};

// "layer.nvpaint", "layer.nvpaint:tint" or "layer.nvpaint:tint:0.5" each; normal and 1 where nothing is said. Throws
// InputError.
PaintStack read_paint_stack(const std::vector<std::string>& names, const voctree::PaintedField& field);

// normal, multiply, tint, recolour.
stage::PaintBlend parse_blend(const std::string& option, const std::string& text);

}  // namespace neuvv::tools
