// The sound of the stage: what is heard, and the waveforms that the timeline draws.
#pragma once

#include "editor/sound_player.h"
#include "editor/waveforms.h"
#include "tools/viewer/context.h"

namespace neuvv::viewer {

struct StageSound {
    // To be called once a frame: plays what the eye hears at the time of the clock. Notices say what cannot be read.
    void follow(Context& context);

    editor::SoundPlayer player;
    editor::Waveforms waveforms{ui::Window::wake};
};

}  // namespace neuvv::viewer
