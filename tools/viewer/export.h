// Images and videos of the stage, drawn between the images of the window and written as they come.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "editor/render_thread.h"
#include "tools/image_sink.h"

namespace neuvv::viewer {

struct ExportSettings {
    tools::ImageOutput output;  // no .exr
    media::ImageSize size{1920, 1080};
    double fps = 25, first_s = 0;
    uint32_t images = 1, samples = 2;
    // At a time of the stage, of the export's size.
    std::function<stage::Camera(const stage::Stage& stage, const stage::EvaluatedStage& evaluated)> camera;
    bool with_background = true;  // else images keep their alpha
};

// One export. The window's thread makes it, asks it and cancels it; the drawer's does its steps.
class Export {
  public:
    // Throws InputError where the settings do not fit together, or the file cannot be written.
    explicit Export(ExportSettings settings);

    // A step: a block of an image, in about the time of a moving image. False: it is over.
    bool step(editor::OnDevice& on_device);

    void cancel() { cancelled_ = true; }
    uint32_t finished_images() const { return finished_; }
    const ExportSettings& settings() const { return settings_; }
    // What there is to say when it is over, and whether that is an error.
    struct End {
        std::string text;
        bool error = false;
    };
    std::optional<End> end() const;

  private:
    void draw_block(editor::OnDevice& on_device);
    void finish_image();
    bool stop(std::string text, bool error);

    ExportSettings settings_;
    std::atomic<bool> cancelled_ = false;
    std::atomic<uint32_t> finished_ = 0;
    mutable std::mutex mutex_;
    std::optional<End> end_;
    // The drawer's.
    std::unique_ptr<tools::ImageSink> sink_;
    uint32_t block_ = 0, side_ = 1;  // of side × side in the image that is drawn
    media::Image image_;
};

}  // namespace neuvv::viewer
