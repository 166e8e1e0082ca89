// The waveforms of sounds that are displayed, read by a thread of their own: hours of sound take minutes to decode.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>

#include "base/file_stamp.h"
#include "media/sound_peaks.h"

namespace neuvv::editor {

class Waveforms {
  public:
    using Files = std::set<std::filesystem::path>;

    // `wake` is called from the thread when a waveform has been read or could not be.
    explicit Waveforms(std::function<void()> wake) : wake_(std::move(wake)) {}
    ~Waveforms();
    Waveforms(const Waveforms&) = delete;
    Waveforms& operator=(const Waveforms&) = delete;

    // The files with sounds that are displayed from now on, or their addresses. Nothing waits for them: the thread,
    // which begins with the first file, reads each, and again when it has changed, which it looks for now and once a
    // second. What is no longer among the files is forgotten.
    void follow(Files files);

    // Null until the file has been read, and where it cannot be read. While it is read again, the waveform that it had.
    std::shared_ptr<const media::SoundPeaks> of(const std::filesystem::path& file) const;

    // A line that says why a file has no waveform; once for each version of the file, mostly empty.
    std::string take_problem();

  private:
    struct Known {
        std::optional<FileStamp> stamp;
        std::shared_ptr<const media::SoundPeaks> peaks;
    };
    void run();
    void read_changed(const std::filesystem::path& file);
    bool is_wanted(const std::filesystem::path& file) const;

    std::function<void()> wake_;
    std::stop_source stop_source_;  // of downloads
    mutable std::mutex mutex_;      // guards what follows
    std::condition_variable changed_;
    Files files_;
    bool looks_now_ = false;
    bool stop_ = false;
    std::map<std::filesystem::path, Known> known_;  // of `files_` alone
    std::deque<std::string> problems_;
    std::thread thread_;
};

}  // namespace neuvv::editor
