// The layers of the .exr files that `neuvv render` writes.
#pragma once

#include <optional>

#include "media/image_sink.h"
#include "render/frame/frame_renderer.h"
#include "render/frame/image_layers.h"

namespace neuvv::tools {

struct ExrLayers {
    bool rgba = true, depth = true, ids = false, deep = false;
    bool needs_segments() const { return ids || deep; }
};

// "rgba,depth,ids,deep" or some of them; empty: the default. Throws InputError.
ExrLayers parse_layers(const std::string& text);

// Empties rgba and depth where they are not wanted.
void remove_unwanted(media::LinearImage& linear, const ExrLayers& layers);

// Adds the last image of a renderer to the sink: `linear`, of which layers that are not wanted are removed, and what
// the segments of its rays make. `names` has the name of each performer.
void add_layers(media::ImageSink& sink, uint32_t i, const ExrLayers& layers, media::LinearImage linear,
                render::FrameRenderer& renderer, const stage::Camera& camera, const render::FrameSettings& settings,
                std::span<const std::string> names, const render::SetRays& set = {});

}  // namespace neuvv::tools
