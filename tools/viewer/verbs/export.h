// Exports images and videos of the stage: the render thread draws them between the images of the window; other threads
// write each one while the next is drawn. A video gets the sound of the stage when all of its images are written.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "editor/draw/render_thread.h"
#include "media/image_sink.h"
#include "tools/viewer/verbs/export_sound.h"

namespace neuvv::viewer {

struct ExportSettings {
    media::ImageOutput output;  // not .exr
    media::ImageSize size{1920, 1080};
    double fps = 25, first_s = 0;      // images per second of the stage; the stage time of the first image
    uint32_t images = 1, samples = 2;  // how many images; rays per pixel along each side
    bool far_levels = true;            // FrameSettings::far_levels
    // The camera at the time of `evaluated`. It must have `size`. Any thread may call it, at any time of the stage.
    std::function<stage::Camera(const stage::Stage& stage, const stage::EvaluatedStage& evaluated)> camera;
    bool with_background = true;  // else images have the alpha of what they show
    // The stage that is heard in a video, and which of its performers are; null: the video has no sound.
    std::shared_ptr<const stage::Stage> heard_stage;
    stage::StageSound::IsHeard is_heard;
};

// One export. The window's thread constructs, watches and cancels it; the render thread calls step().
class Export {
  public:
    // Throws InputError where the settings contradict each other, or where the file cannot be written.
    explicit Export(ExportSettings settings);

    // Draws one block of an image, which takes about as long as an image of a moving view, or waits a little for the
    // sound that is added. Returns false when the export has ended.
    bool step(editor::OnDevice& on_device);

    void cancel() { stop_.request_stop(); }
    uint32_t finished_images() const { return finished_; }
    const ExportSettings& settings() const { return settings_; }
    // How the export ended: a line for the user, and whether it is an error.
    struct End {
        std::string text;
        bool error = false;
    };
    std::optional<End> end() const;  // nullopt: it goes on

  private:
    void draw(editor::OnDevice& on_device);
    void draw_block(editor::OnDevice& on_device);
    void finish_image();
    bool is_drawn() const { return finished_ == settings_.images; }
    bool stop_cancelled();
    bool stop(std::string text, bool error);

    ExportSettings settings_;
    std::stop_source stop_;  // shared with the threads of the sound
    std::atomic<uint32_t> finished_ = 0;
    mutable std::mutex mutex_;
    std::optional<End> end_;
    // Used by the render thread alone.
    std::unique_ptr<media::ImageSink> sink_;
    uint32_t block_ = 0, side_ = 1;  // the next block; the blocks of an image are side_ × side_
    media::Image image_;
    std::unique_ptr<ExportSound> sound_;  // null: there is none
};

}  // namespace neuvv::viewer
