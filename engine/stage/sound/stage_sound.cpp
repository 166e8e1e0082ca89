#include "stage/sound/stage_sound.h"

#include <cmath>
#include <map>
#include <utility>

#include "stage/sound/pan.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::stage {

namespace {

using media::kSoundHop;
using media::kSoundRate;

}  // namespace

StageSound::StageSound(const Stage& stage, double begin_s, EarAt ear_at, const IsHeard& is_heard,
                       const std::stop_token& stop)
    : stage_(stage), begin_s_(begin_s), ear_at_(std::move(ear_at)) {
    const EvaluatedStage evaluated = stage_at(stage, begin_s);
    const glm::dmat4 world_from_ear = ear_at_(evaluated);
    std::map<std::filesystem::path, std::shared_ptr<const media::Sound>> sounds;
    for (const EvaluatedPerformer& shown : evaluated.performers) {
        const StagePerformer& performer = stage.performers[shown.performer];
        if (!performer.settings.sound || !shown.visible) continue;
        if (is_heard && !is_heard(shown.performer)) continue;
        auto& sound = sounds[performer.sound];
        if (!sound)
            sound = std::make_shared<const media::Sound>(media::read_sound(voctree::sound_here(performer.sound, stop)));
        const auto own_gain = static_cast<float>(std::pow(10, performer.settings.sound->gain_db / 20));
        heard_.push_back({shown.performer, sound, Heard(*sound, performer.timeline, begin_s), own_gain, {}});
        heard_.back().gains = gains_of(heard_.back(), evaluated, world_from_ear);
    }
}

// Nothing while an animation makes the performer flat: its place may not be finite.
StageSound::Gains StageSound::gains_of(const OfPerformer& one, const EvaluatedStage& evaluated,
                                       const glm::dmat4& world_from_ear) {
    const EvaluatedPerformer& performer = evaluated.performers[one.performer];
    if (!performer.visible) return {};
    return pan_gains(glm::dvec3(glm::inverse(world_from_ear) * performer.world_from_performer[3]));
}

void StageSound::next(std::array<media::StereoSample, kSoundHop>& samples) {
    samples.fill({});
    if (is_silent()) return;
    ++hops_;
    const EvaluatedStage evaluated = stage_at(stage_, begin_s_ + static_cast<double>(hops_ * kSoundHop) / kSoundRate);
    const glm::dmat4 world_from_ear = ear_at_(evaluated);
    for (OfPerformer& one : heard_) {
        std::array<media::StereoSample, kSoundHop> own{};
        one.heard.add_hop(own, one.own_gain);
        const Gains next = gains_of(one, evaluated, world_from_ear);
        for (size_t i = 0; i < kSoundHop; ++i) {
            const float mono = (own[i][0] + own[i][1]) / 2;
            const float passed = static_cast<float>(i + 1) / kSoundHop;
            for (size_t side = 0; side < 2; ++side)
                samples[i][side] += mono * std::lerp(one.gains[side], next[side], passed);
        }
        one.gains = next;
    }
}

}  // namespace neuvv::stage
