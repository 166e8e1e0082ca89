// The runtime, the device that it created, and the stage on that device.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>

#include "render/clips/clip_preload.h"
#include "render/clips/stage_pick.h"
#include "render/clips/stage_renderer.h"
#include "tools/headset/program.h"
#include "xr/runtime.h"

namespace neuvv::headset {

// Prints what the validation layers report of a device, at the latest before the device is destroyed.
struct ValidationPrinter {
    const gpu::Device& device;
    ~ValidationPrinter() { print(); }
    void print() const;  // the messages since the last call
};

struct RuntimeContext {
    explicit RuntimeContext(Program& program);
    ~RuntimeContext() { painter.project_image = {}; }
    RuntimeContext(const RuntimeContext&) = delete;
    RuntimeContext& operator=(const RuntimeContext&) = delete;
    // Creates the renderer, where there is none yet, for the first session's images.
    void make_renderer(Program& program, const EyeImages& eyes);
    // Shows the document where it was edited since. An edit that cannot be shown is taken back. Has the clip of a new
    // performer read meanwhile.
    void follow(Program& program);
    void read_new_clip(HeadsetState& state);
    // The same for the clips of the document that is to be opened next.
    void read_next_document(HeadsetState& state);
    // Sets state.solid for the time of state.evaluated.
    void update_solid(HeadsetState& state) const;
    // As FindSurfaces (pointing.h), on the stage as it was drawn last. Where images overlap, the results are those of
    // the rays of the call before, so that nobody waits for the image that is under way. Where the stage has changed
    // since, or rays are not near those, it waits for the results of the new rays.
    std::vector<std::optional<SurfaceHit>> find_surfaces(const stage::EvaluatedStage& evaluated,
                                                         std::span<const Ray> rays);

    xr::Runtime runtime;
    gpu::Device device;
    ValidationPrinter validation{device};
    // All clips that were ever on the stage, so that undoing a deletion reads no file between two frames. Of segmented
    // clips it is one segment, of streams one frame, from which performers go on.
    std::map<std::filesystem::path, std::shared_ptr<const render::Field>> clips;
    std::unique_ptr<render::StageLoader> loader;
    std::unique_ptr<render::ClipPreload> preload;     // of the clip of a new performer
    std::unique_ptr<render::ClipPreload> next_clips;  // of the document that is to be opened next
    std::atomic<size_t> next_clips_read = 0;
    std::unique_ptr<render::StageRenderer> renderer;  // created with the first session, for the size of its images
    std::shared_ptr<const stage::Stage> drawn_stage;
    bool overlaps;  // images_overlap()
    render::PerformerPicks picks;
    std::shared_ptr<const stage::Stage> picked_stage;  // on which `picks` were begun, and with which rays
    std::vector<Ray> picked_rays;
    HandPainter& painter;  // projects images on this device
};

}  // namespace neuvv::headset
