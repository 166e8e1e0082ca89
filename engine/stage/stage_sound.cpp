#include "stage/stage_sound.h"

#include <cmath>
#include <map>

#include "stage/evaluated_stage.h"

namespace neuvv::stage {

StageSound::StageSound(const Stage& stage, double begin_s, const IsHeard& is_heard) {
    std::map<std::filesystem::path, std::shared_ptr<const media::Sound>> sounds;
    for (const EvaluatedPerformer& evaluated : stage_at(stage, begin_s).performers) {
        const StagePerformer& performer = stage.performers[evaluated.performer];
        if (!performer.settings.sound || !evaluated.visible) continue;
        if (is_heard && !is_heard(evaluated.performer)) continue;
        auto& sound = sounds[performer.sound];
        if (!sound) sound = std::make_shared<const media::Sound>(media::read_sound(performer.sound));
        heard_.push_back({sound, Heard(*sound, performer.timeline, begin_s),
                          static_cast<float>(std::pow(10, performer.settings.sound->gain_db / 20))});
    }
}

void StageSound::next(std::array<media::StereoSample, media::kSoundHop>& samples) {
    samples.fill({});
    for (OfPerformer& one : heard_) one.heard.add_hop(samples, one.gain);
}

}  // namespace neuvv::stage
