// Draws a view of the stage that is on the device: first with as many rays as there is time for. A view that does not
// change is drawn again, block by block, with all its rays, and once what it lacks has been read.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "editor/draw/block_grid.h"
#include "editor/draw/dynamic_scale.h"
#include "editor/draw/stage_on_device.h"

namespace neuvv::editor {

// For the render thread alone. All images are published in the state.
class ViewDrawer {
  public:
    ViewDrawer(const gpu::Device& device, StageOnDevice& stage, RenderState& state);
    // Frees all that is on the device, and forgets the view.
    void release();

    // Draws this view of the stage, which must be there.
    void draw(ViewRequest view);
    // Draws the last view again, where there is one.
    void draw_again();
    // The size of the last view.
    std::optional<VkExtent2D> size() const;

    // When go_on() has something to do; nullopt: the view is finished, or moves.
    std::optional<std::chrono::steady_clock::time_point> due() const;
    // Draws the next block, or looks whether what the view lacks has been read.
    void go_on();
    // The image stays as it is until the next draw().
    void stop_refining() { refinement_.reset(); }

  private:
    // Of a view that does not change: which block is drawn next.
    struct Refinement {
        uint32_t next = 0;     // the next block of the grid
        uint32_t samples = 1;  // of this round; see ViewRequest
        std::chrono::steady_clock::time_point start;
        DisplayedImage displayed;
    };
    void fit(VkExtent2D size);
    void refine();
    void look_for_missing();
    void note_waiting(bool waits, const stage::EvaluatedStage& evaluated);
    void draw_block(uint32_t block, uint32_t side, uint32_t samples);
    render::FrameSettings settings_at(const stage::EvaluatedStage& evaluated) const;
    void draw_to_image(const stage::Camera& camera, const render::FrameSettings& settings, VkOffset2D at);

    const gpu::Device& device_;
    StageOnDevice& stage_;
    RenderState& state_;
    std::optional<ViewRequest> view_;
    std::shared_ptr<const gpu::DeviceImage> image_;  // to be displayed once something was drawn into it
    DynamicScale scale_;
    BlockGrid grid_;
    std::optional<Refinement> refinement_;
    // When to look whether what a view that does not change lacks has been read; nothing: it lacks nothing.
    std::optional<std::chrono::steady_clock::time_point> look_at_;
    std::vector<std::pair<const render::Field*, float>> shown_;  // what was drawn last, to be compared alone
};

}  // namespace neuvv::editor
