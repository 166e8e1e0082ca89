// The sound of a video that is exported. Threads of its own read it and write it, as both may take long: who exports
// looks in between whether they are done.
#pragma once

#include <filesystem>
#include <future>
#include <memory>
#include <stop_token>

#include "stage/sound/stage_sound.h"

namespace neuvv::viewer {

class ExportSound {
  public:
    // Begins to read what is heard of the stage from a stage time on. Both functions are called on other threads. Once
    // a stop is requested of `stop`, nothing more is read, and add_to() returns false whatever was written.
    ExportSound(std::shared_ptr<const stage::Stage> stage, double begin_s, const stage::StageSound::EarAt& ear_at,
                const stage::StageSound::IsHeard& is_heard, std::stop_source stop);
    // Requests that stop. It may wait until a file is read.
    ~ExportSound();
    ExportSound(const ExportSound&) = delete;
    ExportSound& operator=(const ExportSound&) = delete;

    // To be called while the images are drawn, so that an export does not end with a sound that cannot be read. Throws
    // InputError where reading has failed by now, RuntimeFailure where there is no encoder.
    void expect_readable();

    // Adds the sound to a video that is written; where nobody is heard, the video stays as it is. To be called again
    // until it returns true: each call waits for some milliseconds. Throws InputError and RuntimeFailure.
    bool add_to(const std::filesystem::path& video);

  private:
    std::shared_ptr<const stage::Stage> stage_;
    std::stop_source stop_;
    std::unique_ptr<stage::StageSound> sound_;  // once it is read
    std::future<std::unique_ptr<stage::StageSound>> reading_;
    std::future<void> writing_;  // the last members, because their threads use those above
};

}  // namespace neuvv::viewer
