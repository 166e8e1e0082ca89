// Draws meshes on the processor, to say how much is lost.
#pragma once

#include "interchange/mesh/atlas.h"
#include "media/exr.h"
#include "media/image.h"
#include "stage/camera.h"

namespace neuvv::interchange {

// What a file of a mesh holds of a frame: triangles with a texture, or with a colour of each vertex.
struct ColouredMesh {
    MappedMesh mesh;  // without uvs where there is no texture
    media::Image texture;
    std::vector<std::array<uint8_t, 3>> colours;  // sRGB-encoded; empty where there is a texture
};

// Unlit, in linear light and premultiplied, the mean of samples × samples rays a pixel; `depth_m` is the mean depth
// along the camera's axis, as neuvv::render::linear_image has it. Textures are read by bilinear interpolation of
// encoded values. Both sides of triangles are drawn; those that come nearer to the eye's plane than a centimetre are
// left out.
media::LinearImage mesh_image(const ColouredMesh& mesh, const stage::Camera& camera, uint32_t samples);

}  // namespace neuvv::interchange
