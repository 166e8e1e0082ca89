#include "tools/viewer/verbs/export_sound.h"

#include <chrono>

#include "base/error.h"
#include "media/sound.h"

namespace neuvv::viewer {

namespace {

constexpr std::chrono::milliseconds kPatience{20};

}  // namespace

ExportSound::ExportSound(std::shared_ptr<const stage::Stage> stage, double begin_s,
                         const stage::StageSound::EarAt& ear_at, const stage::StageSound::IsHeard& is_heard,
                         std::stop_source stop)
    : stage_(std::move(stage)), stop_(std::move(stop)) {
    reading_ = std::async(std::launch::async, [this, begin_s, ear_at, is_heard] {
        const auto is_still_heard = [&](uint32_t performer) {
            return !stop_.stop_requested() && (!is_heard || is_heard(performer));
        };
        return std::make_unique<stage::StageSound>(*stage_, begin_s, ear_at, is_still_heard, stop_.get_token());
    });
}

ExportSound::~ExportSound() {
    stop_.request_stop();
}

void ExportSound::expect_readable() {
    if (sound_ || reading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    sound_ = reading_.get();
    if (!sound_->is_silent()) media::expect_sound_encoder();
}

bool ExportSound::add_to(const std::filesystem::path& video) {
    if (!sound_) {
        reading_.wait_for(kPatience);
        expect_readable();
    }
    // After a stop, a stage of which not everything was read may look silent.
    if (!sound_ || stop_.stop_requested()) return false;
    if (sound_->is_silent()) return true;
    if (!writing_.valid())
        writing_ = std::async(std::launch::async, [this, video] {
            media::add_sound(video, [&](auto& samples) {
                if (stop_.stop_requested()) throw RuntimeFailure("the export was cancelled");
                sound_->next(samples);
            });
        });
    if (writing_.wait_for(kPatience) != std::future_status::ready || stop_.stop_requested()) return false;
    writing_.get();
    return true;
}

}  // namespace neuvv::viewer
