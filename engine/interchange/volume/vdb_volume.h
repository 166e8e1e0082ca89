// Volumes of OpenVDB files as trees, and images of them on the processor.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "interchange/volume/vdb_reader.h"
#include "media/image.h"
#include "stage/camera.h"
#include "voctree/voctree.h"

namespace neuvv::interchange {

// Finds the values of a grid by their indices. The grid must outlive it.
class VdbLookup {
  public:
    explicit VdbLookup(const VdbGrid& grid);
    // Null where the voxel is not active.
    const float* at(const glm::ivec3& index);

  private:
    const VdbGrid& grid_;
    std::unordered_map<uint64_t, const VdbBlock*> blocks_;
    std::array<std::unordered_map<uint64_t, const VdbTile*>, 3> tiles_;  // by their edges
    uint64_t last_ = UINT64_MAX;                                         // the block that was asked for last
    const VdbBlock* last_block_ = nullptr;
    const VdbTile* last_tile_ = nullptr;
};

// What a file shows: light is dimmed by `density`, per unit of the file, and comes from voxels of `colour`, in linear
// light; white where there is none.
struct VdbVolume {
    std::string file;
    VdbGrid density;
    std::optional<VdbGrid> colour;
    glm::dmat4 world_from_file{1};   // axes and metres
    std::vector<std::string> notes;  // which grids were chosen, and which were not
};

// The numbers "density" of a file, or else its only grid of numbers, and the vectors "Cd", "color", "colour" or
// "albedo"; of several grids of one name the first, as OpenVDB's own readGrid takes it. Level sets are no densities.
// `world_from_file`: turns and scales all axes alike; `file` is for errors. Throws InputError, which lists the grids,
// where there is no such one, and where its voxels do not lie along the axes.
VdbVolume volume_of(std::vector<VdbGrid> grids, const std::string& file, const glm::dmat4& world_from_file);

// How often the edges of voxels are doubled until the volume has at most `resolution` cells along its longest side;
// nothing where it is empty.
std::optional<uint32_t> doublings_for(const VdbVolume& volume, uint32_t resolution);

// The tree of one frame with a leaf for each voxel or tile, or, where `doublings` are asked for, of larger cells that
// pass as much light (voctree::cut_tree). Empty space and active voxels of no density have no leaf. Throws InputError
// where a tree would have too many cells.
voctree::VOctree tree_of(const VdbVolume& volume, uint32_t doublings, float fps);

// The volume on a background of linear light, sRGB-encoded: density and colour are interpolated between the centres of
// voxels, as renderers of such files do it. `between` is called once a row, from several threads, and may throw.
media::Image vdb_image(const VdbVolume& volume, const stage::Camera& camera, const std::function<void()>& between,
                       const glm::vec3& background = glm::vec3(1));

}  // namespace neuvv::interchange
