#include "editor/sound_player.h"

#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <future>
#include <map>
#include <optional>
#include <stop_token>

#include "base/error.h"
#include "base/file_stamp.h"
#include "base/seconds.h"
#include "base/trace_file.h"
#include "stage/sound/heard.h"
#include "stage/sound/pan.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::editor {

namespace {

using media::kSoundHop;
using media::kSoundRate;

constexpr uint32_t kHopsAhead = 5;                // that wait in the device: 107 ms
constexpr std::chrono::milliseconds kPeriod{10};  // between looks at the device
constexpr double kMostDrift_s = 0.06;             // between clock and sound, before the sound jumps

}  // namespace

// The stage at a time of seconds_now().
struct SoundPlayer::Wanted {
    std::shared_ptr<const stage::Stage> stage;
    double stage_s = 0, speed = 0, at_s = 0, volume = 1;
    glm::mat4 world_from_ear{1};
    struct Performer {
        uint32_t index;  // among the stage's
        glm::vec3 at;
    };
    std::vector<Performer> performers;  // that are seen and have a sound

    double stage_s_now() const { return stage_s + speed * (seconds_now() - at_s); }
};

// The device. All functions are called by one thread. Where there is no device, nothing is heard.
class SoundPlayer::Output {
  public:
    Output() {
        device_ = alcOpenDevice(nullptr);
        if (!device_) return;
        const bool has_hrtf = alcIsExtensionPresent(device_, "ALC_SOFT_HRTF");
        const ALCint attributes[] = {has_hrtf ? ALC_HRTF_SOFT : 0, ALC_TRUE, 0};
        context_ = alcCreateContext(device_, attributes);
        if (!context_ || !alcMakeContextCurrent(context_)) close();
        if (context_) alDistanceModel(AL_NONE);  // voices have stage::distance_gain, as videos do
    }
    ~Output() {
        stop_.request_stop();
        voices_.clear();
        close();
    }
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;

    bool is_open() const { return context_ != nullptr; }

    // Returns what cannot be read.
    std::string follow(const Wanted& wanted) {
        std::string problem;
        if (wanted.stage != stage_ || wanted.speed != speed_) voices_.clear();
        stage_ = wanted.stage;
        speed_ = wanted.speed;
        set_ear(wanted.world_from_ear);
        alListenerf(AL_GAIN, static_cast<float>(wanted.volume));
        std::erase_if(voices_, [&](const auto& voice) {
            return std::ranges::none_of(wanted.performers, [&](const auto& one) { return one.index == voice.first; });
        });
        for (const Wanted::Performer& one : wanted.performers) {
            auto found = voices_.find(one.index);
            if (found != voices_.end() && std::abs(found->second->stage_s() - wanted.stage_s_now()) > kMostDrift_s) {
                voices_.erase(found);
                found = voices_.end();
            }
            if (found == voices_.end()) {
                const stage::StagePerformer& performer = stage_->performers[one.index];
                const auto sound = sound_of(performer.sound, problem);
                if (!sound) continue;
                found = voices_.emplace(one.index, std::make_unique<Voice>(sound, performer, wanted)).first;
            }
            const glm::vec3 ear(wanted.world_from_ear[3]);
            found->second->play(one.at, static_cast<float>(stage::distance_gain(glm::distance(one.at, ear))));
        }
        return problem;
    }

  private:
    // A performer's sound on its way to the device.
    class Voice {
      public:
        Voice(std::shared_ptr<const media::Sound> sound, const stage::StagePerformer& performer, const Wanted& wanted)
            : sound_(std::move(sound)),
              begin_s_(wanted.stage_s_now()),
              speed_(wanted.speed),
              gain_(static_cast<float>(std::pow(10, performer.settings.sound->gain_db / 20))),
              heard_(*sound_, performer.timeline, begin_s_, speed_) {
            heard_.begin_softly();
            alGenSources(1, &source_);
            alGenBuffers(static_cast<ALsizei>(buffers_.size()), buffers_.data());
            for (const ALuint buffer : buffers_) fill(buffer);
        }
        ~Voice() {
            alSourceStop(source_);
            alDeleteSources(1, &source_);
            alDeleteBuffers(static_cast<ALsizei>(buffers_.size()), buffers_.data());
        }
        Voice(const Voice&) = delete;
        Voice& operator=(const Voice&) = delete;

        void play(const glm::vec3& at, float distance_gain) {
            alSource3f(source_, AL_POSITION, at.x, at.y, at.z);
            alSourcef(source_, AL_GAIN, distance_gain);
            ALint played = 0, state = 0;
            alGetSourcei(source_, AL_BUFFERS_PROCESSED, &played);
            for (; played > 0; --played) {
                ALuint buffer = 0;
                alSourceUnqueueBuffers(source_, 1, &buffer);
                ++hops_played_;
                fill(buffer);
            }
            alGetSourcei(source_, AL_SOURCE_STATE, &state);
            if (state != AL_PLAYING) alSourcePlay(source_);  // it begins, or the device was faster than this thread
        }
        // The stage time that is heard now.
        double stage_s() const {
            ALint samples = 0;
            alGetSourcei(source_, AL_SAMPLE_OFFSET, &samples);
            const double played = static_cast<double>(hops_played_ * kSoundHop) + samples;
            return begin_s_ + speed_ * played / kSoundRate;
        }

      private:
        // From one place, so both sides become one.
        void fill(ALuint buffer) {
            std::array<media::StereoSample, kSoundHop> stereo{};
            heard_.add_hop(stereo, gain_);
            std::array<int16_t, kSoundHop> mono;
            for (size_t i = 0; i < kSoundHop; ++i)
                mono[i] = static_cast<int16_t>(
                    std::lround(32767 * std::clamp((stereo[i][0] + stereo[i][1]) / 2, -1.0f, 1.0f)));
            alBufferData(buffer, AL_FORMAT_MONO16, mono.data(), sizeof mono, kSoundRate);
            alSourceQueueBuffers(source_, 1, &buffer);
        }

        std::shared_ptr<const media::Sound> sound_;
        double begin_s_, speed_;
        float gain_;
        stage::Heard heard_;
        uint64_t hops_played_ = 0;
        ALuint source_ = 0;
        std::array<ALuint, kHopsAhead> buffers_{};
    };

    void close() {
        alcMakeContextCurrent(nullptr);
        if (context_) alcDestroyContext(context_);
        if (device_) alcCloseDevice(device_);
        context_ = nullptr;
        device_ = nullptr;
    }
    static void set_ear(const glm::mat4& world_from_ear) {
        const glm::vec3 at(world_from_ear[3]), ahead(-world_from_ear[2]), up(world_from_ear[1]);
        const std::array<float, 6> orientation = {ahead.x, ahead.y, ahead.z, up.x, up.y, up.z};
        alListener3f(AL_POSITION, at.x, at.y, at.z);
        alListenerfv(AL_ORIENTATION, orientation.data());
    }
    // A file is read again only when it has changed. Threads of their own read, so that meanwhile the others are heard:
    // null until the file is read, and where it cannot be read.
    std::shared_ptr<const media::Sound> sound_of(const std::filesystem::path& file, std::string& problem) {
        Known& known = sounds_[file];
        const FileStamp stamp = stamp_of(file);
        if (!known.reading.valid() && known.stamp != stamp) {
            const auto read = [file, stop = stop_.get_token()] {
                return std::make_shared<const media::Sound>(media::read_sound(voctree::sound_here(file, stop)));
            };
            known = {stamp, nullptr, std::async(std::launch::async, read)};
        }
        if (!known.reading.valid() || known.reading.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
            return known.sound;
        try {
            known.sound = known.reading.get();
        } catch (const std::exception& error) {
            problem = error.what();
        }
        return known.sound;
    }

    ALCdevice* device_ = nullptr;
    ALCcontext* context_ = nullptr;
    std::shared_ptr<const stage::Stage> stage_;
    double speed_ = 0;
    struct Known {
        std::optional<FileStamp> stamp;
        std::shared_ptr<const media::Sound> sound;
        std::future<std::shared_ptr<const media::Sound>> reading;  // not valid: nothing is being read
    };
    std::stop_source stop_;  // of downloads
    std::map<std::filesystem::path, Known> sounds_;
    std::map<uint32_t, std::unique_ptr<Voice>> voices_;  // by performer
};

SoundPlayer::SoundPlayer() = default;

SoundPlayer::~SoundPlayer() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void SoundPlayer::follow(const std::shared_ptr<const stage::Stage>& stage, const stage::EvaluatedStage& evaluated,
                         double speed, const glm::mat4& world_from_ear) {
    auto wanted =
        std::make_unique<Wanted>(Wanted{stage, evaluated.time_s, speed, seconds_now(), volume_, world_from_ear, {}});
    for (const stage::EvaluatedPerformer& performer : evaluated.performers)
        if (stage && speed != 0 && performer.visible && stage->performers[performer.performer].settings.sound)
            wanted->performers.push_back({performer.performer, glm::vec3(performer.world_from_performer[3])});
    if (!thread_.joinable()) {
        if (wanted->performers.empty()) return;
        thread_ = std::thread([this] { run(); });
    }
    {
        const std::lock_guard lock(mutex_);
        wanted_ = std::move(wanted);
    }
    changed_.notify_all();
}

std::string SoundPlayer::take_problem() {
    const std::lock_guard lock(mutex_);
    return std::exchange(problem_, {});
}

void SoundPlayer::run() {
    name_trace_thread("plays sounds");
    Output output;
    Wanted wanted;
    if (!output.is_open()) {
        const std::lock_guard lock(mutex_);
        problem_ = "no sound is heard: OpenAL finds no device";
        return;
    }
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            const auto is_new = [&] { return stop_ || wanted_; };
            if (wanted.performers.empty())
                changed_.wait(lock, is_new);
            else
                changed_.wait_for(lock, kPeriod, is_new);
            if (stop_) return;
            if (wanted_) wanted = std::move(*std::exchange(wanted_, nullptr));
        }
        if (std::string problem = output.follow(wanted); !problem.empty()) {
            const std::lock_guard lock(mutex_);
            problem_ = std::move(problem);
        }
    }
}

}  // namespace neuvv::editor
