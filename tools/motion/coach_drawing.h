// What `neuvv coach` draws over an image of the trainer.
#pragma once

#include "coach/coach.h"
#include "media/image.h"
#include "stage/camera.h"

namespace neuvv::tools {

// The ghost and the arrows (coach/guide.h) as lines, with nothing in front of them. The camera is that of the image, in
// world metres.
void draw_guide(media::Image& image, const stage::Camera& camera, const glm::dmat4& world_from_performer,
                const coach::Coach& coach);

// The score and what is wrong, in words at the top left.
void draw_remarks(media::Image& image, const coach::Coach& coach);

}  // namespace neuvv::tools
