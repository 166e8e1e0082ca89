// Draws Gaussian splats on the processor, as their definition says: to find the shape of splats that looks most like a
// clip, and to say how much is lost.
#pragma once

#include "interchange/splats/splats.h"
#include "media/image.h"
#include "stage/camera.h"

namespace neuvv::interchange {

// On an opaque background, sRGB-encoded (0 to 1). Splats are sorted by the depth of their centres; each is projected by
// the derivative of the projection at its centre, widened by 0.3 pixels² as all renderers of splats do, and composited
// in sRGB. Splats nearer than a centimetre are left out.
media::Image splat_image(const Splats& splats, const stage::Camera& camera, const glm::vec3& background);

// Adds to `weights`, one of each splat, by how much the splat makes the pixels of that image: transmittance · alpha.
void add_weights(const Splats& splats, const stage::Camera& camera, std::vector<float>& weights);

}  // namespace neuvv::interchange
