// The set of a stage: a glTF scene under its lights. The rays of volumes end at it and are composited over it.
//
//     pose, light ─► record_shadows ─► record_solid ─► colour, depth
//                    (volumes, up to depth ─► volume_depth) ─► record_transparent ─► colour, front
//
// The image of a view is then `front` over the volumes over `colour`. There is one sample per texel; a frame may take
// several texels per pixel.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/set/hidden_parts.h"
#include "render/set/set_backdrop.h"
#include "render/set/set_lighting.h"
#include "render/set/set_meshes.h"
#include "render/set/set_targets.h"

namespace neuvv::render {

constexpr double kSetNear_m = 0.02;  // distance of the near plane

// Draws one scene for at most `views` views of at most width × height texels. Posing, lighting and recording create no
// Vulkan objects. All functions but the record_ functions write memory that draws read: no work that was recorded here
// may be under way meanwhile.
class SetRaster {
  public:
    // Throws RuntimeFailure where the scene exceeds the device. The scene must outlive the raster. `environment` is as
    // make_environment's image, or null; it is not needed afterwards.
    SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height, uint32_t views,
              const media::Image* environment = nullptr);
    SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height, uint32_t views,
              std::shared_ptr<const SetEnvironment> environment);
    SetRaster(const SetRaster&) = delete;
    SetRaster& operator=(const SetRaster&) = delete;

    // Replaces the scene by another one, which must outlive the raster; the old scene is read for the last time.
    // Pipelines and images stay, and so do vertices, textures and materials that are equal in both scenes; to compare
    // them takes as long as to read both. The raster must be posed and lit again. Throws RuntimeFailure where the scene
    // exceeds the device, and then still draws the old scene.
    void change(const stage::GltfScene& scene, std::shared_ptr<const SetEnvironment> environment);
    // Replaces the buffers of targets(): passes that are bound to them must be created again. Throws RuntimeFailure
    // where there is no memory, and must then be called again before anything is drawn.
    void resize(uint32_t width, uint32_t height);

    // Sets the pose of the scene. Vertices that did not move are not written.
    // Whether the pose is the present one already. If not, pose() writes what draws read, and no submitted work may
    // draw the set meanwhile.
    bool has_pose(const stage::PosedScene& pose) const;
    void pose(const stage::PosedScene& pose);

    // Sets the parts of each view's image that nobody can see (because of a headset's lenses) until the next call. A
    // list has the corners of triangles, as fractions of the image's width and height from the upper left. Rays end
    // there at once, and nothing is shaded. There must be a list for each view, or none (assert).
    void hide(std::span<const std::vector<glm::vec2>> corners);

    // Where a height is given (world, metres), draws neither scene nor environment until the next call, but what
    // performers' shadows take of the light on a horizontal floor at this height: black, with alpha below 1. Without
    // shadow, `colour` is 0 there. Rays end at the floor.
    void catch_shadows(std::optional<double> floor_m);

    // Draws the shadow maps of the set, after lighting.record_lights. Records nothing where neither the set nor the
    // lights with shadows have changed.
    void record_shadows(gpu::Commands& commands);
    // Draws opaque and masked pieces, and the environment behind them where it is shown → colour, depth. One camera per
    // view, all of the same size.
    void record_solid(gpu::Commands& commands, std::span<const stage::Camera> cameras);
    // Draws blended pieces, far to near by the centres of their primitives' boxes. What is behind volume_depth is
    // blended over `colour`, what is before it goes → front. To be recorded after record_solid with the same cameras.
    void record_transparent(gpu::Commands& commands, std::span<const stage::Camera> cameras);

    // Whether blended pieces are drawn. If not, record_transparent does nothing and `front` stays 0.
    bool has_transparent() const { return meshes_.has_blended() && !catcher_.has_floor(); }
    const SetTargets& targets() const { return targets_; }

    SetLighting lighting;

  private:
    SetSurroundings surroundings(const SetEnvironment& environment) const {
        return {environment, lighting, targets_.volume_depth};
    }
    // Removes blended pieces that were drawn and no longer are.
    void clear_front(bool had_transparent);
    SetPush push_of(const stage::Camera& camera, uint32_t view) const;
    void record_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view);

    const gpu::Device& device_;
    SetTargets targets_;
    SetMeshes meshes_;
    SetBackground background_;
    ShadowCatcher catcher_;
    HiddenParts hidden_;
};

}  // namespace neuvv::render
