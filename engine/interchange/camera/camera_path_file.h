// Camera paths as files: NeuVV's own, instant-ngp's, nerfstudio's, and cameras of glTF and OpenUSD. ../README.md says
// what is read from each, and what is written.
#pragma once

#include <filesystem>

#include "stage/camera_path.h"
#include "stage/stage.h"
#include "voctree/files/world_frame.h"

namespace neuvv::interchange {

// A .usda has OpenUSD's camera, a .gltf or .glb that of a stage, with `views_per_s` keys a second where it moves
// (stage::path_of_camera). Of JSON, recognises the format by its keys: `frames` (a transforms.json), `path`
// (instant-ngp), `camera_path` or `keyframes` (nerfstudio). The frames of a transforms.json without `seconds` are
// separate views, `views_per_s` of them a second (Interpolation::kCut). But for stages, files have the coordinates of
// the capture, and the path those of its clip, which stands there by `frame`. Throws InputError with the file and the
// place in its JSON.
stage::CameraPath read_camera_path(const std::filesystem::path& file, double views_per_s,
                                   const voctree::WorldFrame& frame = {});

// The frame of the performers' clips in the coordinates of their capture (voctree/files/world_frame.h), which is that
// of a stage, too; the capture's own coordinates where performers are of several captures.
voctree::WorldFrame frame_of(const stage::Stage& stage);

// The path of a clip in the coordinates of its capture, to be written.
stage::CameraPath in_capture(stage::CameraPath path, const voctree::WorldFrame& frame);

// Writes a transforms.json with `seconds`, which reads back as the same path. The file is replaced atomically.
void write_camera_path(const std::filesystem::path& file, const stage::CameraPath& path);

// Both write images (stage::by_images, which have a size and fps) for other programs, in a world with +Z up.
// read_camera_path reads the same images back. `world` may be empty; else it is the file by which that program moved
// the world of the data set: instant-ngp's transforms.json with `scale` and `offset`, or nerfstudio's
// dataparser_transforms.json with `transform` and `scale`; these members are added to the file, so that it can be read
// back. Lenses have square pixels and no shift. The file is replaced atomically. Throws InputError for a bad `world`.
void write_ngp_path(const std::filesystem::path& file, const stage::CameraPath& images,
                    const std::filesystem::path& world);
// `path` has the keys of which the images were made, which nerfstudio's viewer shows.
void write_nerfstudio_path(const std::filesystem::path& file, const stage::CameraPath& path,
                           const stage::CameraPath& images, const std::filesystem::path& world);

}  // namespace neuvv::interchange
