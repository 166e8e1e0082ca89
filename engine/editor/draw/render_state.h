// What the render thread says of itself to other threads: the image to be displayed, the stage that it shows, and what
// is being read.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gpu/commands.h"
#include "gpu/image.h"
#include "stage/stage.h"

namespace neuvv::editor {

// The image to be displayed now.
struct DisplayedImage {
    uint64_t number = 0;  // increases each time the image changes
    uint64_t view = 0;    // the id of its request; 0: none yet
    uint64_t stage = 0;   // the id that show() got with its stage
    // In layout TRANSFER_SRC. It is written on the device's queue, so that commands submitted there later read the
    // finished image. Null before the first image.
    std::shared_ptr<const gpu::DeviceImage> image;
    VkExtent2D size{};  // pixels at the image's upper left that are displayed
    double scale = 1;   // rays per pixel along each side
    bool finished = false;
    double milliseconds = 0;  // that drawing took, for all blocks together
    std::vector<gpu::PassTime> passes;
    uint64_t live_leaves = 0;
};

struct RenderThreadState {
    std::shared_ptr<const stage::Stage> stage;  // the stage that is drawn; null before the first
    uint64_t stage_id = 0;                      // the id that show() got with it
    // Per clip: the corners, low and high, of the box around its leaves, in the performer's space in metres.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> leaf_boxes;
    DisplayedImage displayed;
    std::string loading;  // the file whose clips are being read, or "shaders"; empty: nothing
    size_t files_read = 0, files = 0;
    // Since when the image shows something else than performers have at its time, because that is still being read, and
    // has not changed meanwhile; nothing: it shows what it should.
    std::optional<std::chrono::steady_clock::time_point> waits_since;
    std::string problem;      // why the newest stage, image or task failed; empty: no problem
    uint64_t unsound_id = 0;  // the id that show() got with the last document that is not sound
};

// The newest RenderThreadState. Every function may be called on any thread.
class RenderState {
  public:
    // `wake` is called after report() and publish(), on the thread that calls these.
    explicit RenderState(std::function<void()> wake) : wake_(std::move(wake)) {}

    // A copy. Throws the exception that ended the render thread, where one did.
    RenderThreadState now() const;
    uint64_t displayed_number() const;

    // Calls `set` under the lock, to change what now() returns; report() then calls `wake`, too.
    void change(const std::function<void(RenderThreadState&)>& set);
    void report(const std::function<void(RenderThreadState&)>& set);
    // Displays an image, which gets the next number.
    void publish(DisplayedImage displayed);
    // That clips of `file` are being read, of which `done` of `of` are there.
    void report_progress(const std::string& file, size_t done, size_t of);
    // Why the newest stage, image or task failed. `unsound_id`: of the document, where it is not sound; else 0.
    void report_problem(const std::string& problem, uint64_t unsound_id);
    // The render thread has ended by this exception; null: it begins again.
    void set_failure(std::exception_ptr failure);
    void wake() const { wake_(); }

  private:
    mutable std::mutex mutex_;
    std::function<void()> wake_;
    RenderThreadState state_;
    std::exception_ptr failure_;
};

}  // namespace neuvv::editor
