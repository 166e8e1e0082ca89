#include "tools/render/render_layers.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/text.h"

namespace neuvv::tools {

ExrLayers parse_layers(const std::string& text) {
    ExrLayers layers;
    if (text.empty()) return layers;
    layers = {false, false, false, false};
    const std::pair<const char*, bool*> known[] = {
        {"rgba", &layers.rgba}, {"depth", &layers.depth}, {"ids", &layers.ids}, {"deep", &layers.deep}};
    for (const std::string& name : split(text, ',')) {
        const auto found =
            std::find_if(std::begin(known), std::end(known), [&](const auto& layer) { return name == layer.first; });
        if (found == std::end(known))
            throw InputError("--layers", text, "there is no layer \"" + name + "\"",
                             "write some of rgba,depth,ids,deep");
        *found->second = true;
    }
    if (!layers.rgba && !layers.depth && !layers.ids)
        throw InputError("--layers", text, "leaves the .exr itself empty, as deep samples are a file beside it",
                         "add rgba, depth or ids");
    return layers;
}

void remove_unwanted(media::LinearImage& linear, const ExrLayers& layers) {
    if (!layers.rgba) linear.rgba.clear();
    if (!layers.depth) linear.depth_m.clear();
}

void add_layers(media::ImageSink& sink, uint32_t i, const ExrLayers& layers, media::LinearImage linear,
                render::FrameRenderer& renderer, const stage::Camera& camera, const render::FrameSettings& settings,
                std::span<const std::string> names, const render::SetRays& set) {
    remove_unwanted(linear, layers);
    if (!layers.needs_segments()) {
        sink.add(i, std::move(linear));
        return;
    }
    render::ImageLayers made(camera, settings.samples, names, set, {layers.ids, layers.deep}, settings.stop);
    renderer.read_intervals([&](glm::uvec2 ray, auto intervals) { made.add(ray, intervals); });
    made.finish();
    if (layers.ids) linear.ids = std::move(made.ids);
    if (layers.deep)
        sink.add(i, std::move(linear), std::move(made.deep));
    else
        sink.add(i, std::move(linear));
}

}  // namespace neuvv::tools
