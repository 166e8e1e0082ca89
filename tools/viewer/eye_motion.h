// Motion of the eye that goes on by itself: a flight to where it was sent, or the camera path.
#pragma once

#include "tools/viewer/context.h"

namespace neuvv::viewer {

class EyeMotion {
  public:
    // To be called once a frame, after the stage was evaluated. Any other motion of the eye ends that along the path.
    void move(Context& context);

  private:
    struct Flight {
        Eye from, to;
        double begin_s = 0;
    };
    std::optional<Flight> flight_;  // nullopt: the eye does not fly
    std::optional<Eye> path_eye_;   // that the camera path gave in the previous frame
};

// The eye with which a stage is first displayed: that of its first perspective camera, else from the front, a little
// above, with the leaves of all performers in view. There must be a stage.
Eye initial_eye(const Context& context, const stage::EvaluatedStage& evaluated);

}  // namespace neuvv::viewer
