// Compiles what players need to draw a field, before it is drawn for the first time.
#pragma once

#include "render/volume/field.h"

namespace neuvv::render {

// Draws a few small images of the field, and picks in one, so that the device has compiled these passes when the field
// comes on a stage: compilers take as long as many images. May be called from any thread, while others draw. Throws
// RuntimeFailure where the device has no memory.
void warm_up(const gpu::Device& device, const Field& field);

}  // namespace neuvv::render
