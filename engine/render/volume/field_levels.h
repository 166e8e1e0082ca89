// Far levels: coarser copies of a clip's tree on the device, from which performers that are far away are drawn. There
// one ray a pixel would meet one of many leaves by chance, so that the performer shimmers as it moves.
#pragma once

#include <span>

#include "render/volume/slices/field.h"
#include "stage/camera.h"

namespace neuvv::render {

// A field to be played, with its Field::coarser where each frame of the clip has a basis of its own: cut at each octree
// depth that has at most half of the leaves of the level before. They take about a third of its memory more. The tree
// must be sound.
Field upload_far_levels(const gpu::Device& device, const voctree::VOctree& tree);

// The far level at which a performer should be drawn for all of these cameras, with `samples` rays per pixel along each
// side: 0 is the field itself, k is coarser[k − 1]. It is the coarsest whose finest cells look no larger than the
// distance between two rays, at the point of the field's box that is nearest to an eye. Of a performer with an uneven
// scale it is the least distance that is possible between two rays there, whatever their direction. The level depends
// on nothing else, so that images do not depend on those before them, and that parts of an image have the level of the
// whole. It does not follow dynamic resolution (FrameSettings::scale) either, because that follows the time that images
// take.
uint32_t far_level_for(const Field& field, std::span<const stage::Camera> cameras,
                       const glm::mat4& world_from_performer, uint32_t samples);

// Fields with all of their far levels in one list.
struct FieldLevels {
    explicit FieldLevels(std::vector<const Field*> given);
    // The index of a level of the field that was given as number `field`.
    uint32_t index(uint32_t field, uint32_t level) const {
        return level == 0 ? field : first_coarser[field] + level - 1;
    }

    // The field that was given, to which a level belongs.
    const Field& finest(uint32_t level_index) const { return *all[given_of[level_index]]; }

    std::vector<const Field*> all;        // those given, then the coarser levels of each
    std::vector<uint32_t> first_coarser;  // by given field
    std::vector<uint32_t> given_of;       // of each of `all`: the number of the field that was given
    uint32_t given() const { return static_cast<uint32_t>(first_coarser.size()); }
};

}  // namespace neuvv::render
