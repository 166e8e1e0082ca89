// Plays the sounds of a stage while its clock runs, by OpenAL: each from where its performer is, for an ear where the
// eye is, with HRTF where the device has it.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "stage/evaluated_stage.h"
#include "stage/stage.h"

namespace neuvv::editor {

class SoundPlayer {
  public:
    SoundPlayer();
    ~SoundPlayer();
    SoundPlayer(const SoundPlayer&) = delete;
    SoundPlayer& operator=(const SoundPlayer&) = delete;

    // What is to be heard from now on. To be called in each frame of a window: sound follows a clock that jumps within
    // a tenth of a second. `speed` is in stage seconds a second, 0 while the clock stands. Nothing waits for files or
    // for the device; a thread does, which begins with the first stage that has sounds.
    void follow(const std::shared_ptr<const stage::Stage>& stage, const stage::EvaluatedStage& evaluated, double speed,
                const glm::mat4& world_from_ear);

    // How loud all of it is, 1 as the stage says. It holds from the next follow() on.
    void set_volume(double volume) { volume_ = volume; }

    // A line that says why a sound is not heard; once for each, mostly empty.
    std::string take_problem();

  private:
    struct Wanted;
    class Output;
    void run();
    double volume_ = 1;
    std::mutex mutex_;  // guards what follows
    std::condition_variable changed_;
    std::unique_ptr<Wanted> wanted_;  // null: nothing new
    std::string problem_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace neuvv::editor
