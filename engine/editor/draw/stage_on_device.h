// The stage of the render thread on the device. A document whose clips are not there waits until another thread has
// read them; until then, the stage before stays.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "editor/draw/render_queue.h"
#include "editor/draw/render_state.h"
#include "render/clips/clip_preload.h"
#include "render/clips/stage_renderer.h"

namespace neuvv::editor {

// For the render thread alone.
class StageOnDevice {
  public:
    // `clips_read` is called on the thread that reads, once the clips for which a document waits have been read, or one
    // of them cannot be.
    StageOnDevice(const gpu::Device& device, RenderState& state, std::function<void()> clips_read)
        : device_(device), state_(state), clips_read_(std::move(clips_read)) {}
    // Frees all that is on the device; the stage must be shown again.
    void release();

    // Brings the document to the device, for images of `size` pixels, or says in the state why it cannot be drawn.
    // Returns false where it waits for its clips, or these cannot be read.
    bool show(const ShownDocument& document, VkExtent2D size);
    // The same, of the document that waits, after `clips_read`.
    bool show_waiting(VkExtent2D size);
    bool is_waiting() const { return waiting_.has_value(); }

    bool is_there() const { return stage_ != nullptr; }
    // What follows needs a stage that is there.
    OnDevice on_device() { return {device_, *stage_, *renderer_}; }
    const stage::Stage& stage() const { return *stage_; }
    render::StageRenderer& renderer() { return *renderer_; }
    uint64_t id() const { return id_; }
    // The largest image that the renderer can draw.
    VkExtent2D capacity() const { return capacity_; }
    // Makes room for images of this size.
    void fit(VkExtent2D size);
    // Says in the state which segment cannot be read, where that is newly known of one.
    void report_unreadable_segments();

    // Makes the passes anew from other shaders, in a renderer that reads its clips again, and calls `draw`, because
    // some passes are made only when they are first needed. Returns why that failed; then the last ones stay.
    std::string replace_shaders(const gpu::ShaderReplacements& shaders, VkExtent2D size,
                                const std::function<void()>& draw);

  private:
    bool begin_reading(const ShownDocument& document);
    void load(const ShownDocument& document, VkExtent2D size);
    void bring_to_device(const edit::Document& document, VkExtent2D size);
    void make_renderer(const stage::Stage& stage, const render::StageLoader::Loaded& progress, VkExtent2D size);
    void report_read(const std::vector<std::filesystem::path>& clips, size_t read);
    bool is_sound(const edit::Document& document) const;

    const gpu::Device& device_;
    RenderState& state_;
    std::function<void()> clips_read_;
    std::shared_ptr<const edit::Document> document_;
    std::shared_ptr<const stage::Stage> stage_;
    uint64_t id_ = 0;
    std::unique_ptr<render::StageLoader> loader_;  // null before the first renderer
    std::unique_ptr<render::StageRenderer> renderer_;
    VkExtent2D capacity_{};
    std::optional<ShownDocument> waiting_;          // for its clips
    std::unique_ptr<render::ClipPreload> preload_;  // null: no clip is being read
};

}  // namespace neuvv::editor
