#include "tools/stage_sound.h"

#include <cmath>
#include <map>

#include "stage/evaluated_stage.h"

namespace neuvv::tools {

StageSound::StageSound(const stage::Stage& stage, double begin_s) {
    std::map<std::filesystem::path, std::shared_ptr<const media::Sound>> sounds;
    for (const stage::EvaluatedPerformer& evaluated : stage::stage_at(stage, begin_s).performers) {
        const stage::StagePerformer& performer = stage.performers[evaluated.performer];
        if (!performer.settings.sound || !evaluated.visible) continue;
        auto& sound = sounds[performer.sound];
        if (!sound) sound = std::make_shared<const media::Sound>(media::read_sound(performer.sound));
        heard_.push_back({sound, stage::Heard(*sound, performer.timeline, begin_s),
                          static_cast<float>(std::pow(10, performer.settings.sound->gain_db / 20))});
    }
}

void StageSound::next(std::array<media::StereoSample, media::kSoundHop>& samples) {
    samples.fill({});
    for (OfPerformer& one : heard_) one.heard.add_hop(samples, one.gain);
}

}  // namespace neuvv::tools
