// Clips that can be played: .nvv files, and PlenOctrees (.npz) as clips of one frame. Told apart by their first bytes.
#pragma once

#include <filesystem>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Throws InputError (nvv.h, plenoctree.h).
VOctree read_clip(const std::filesystem::path& path);

struct ClipHead {
    uint32_t frames;
    float fps;
    glm::vec3 box_min, box_size;  // metres
};

// What is known of a clip without reading its leaves. Throws InputError for what it does read.
ClipHead read_clip_head(const std::filesystem::path& path);

// ".nvv" or ".npz".
bool has_clip_ending(const std::filesystem::path& path);

// A zip file, which among clips only PlenOctrees are. False where it cannot be read.
bool is_plenoctree(const std::filesystem::path& path);

}  // namespace neuvv::voctree
