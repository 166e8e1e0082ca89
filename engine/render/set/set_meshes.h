// The scene of a set: its triangles, textures and materials on the device, and the pipelines that draw them.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "gpu/graphics_pass.h"
#include "render/set/scene_geometry.h"
#include "render/set/set_lighting.h"
#include "shared/set.h"

namespace neuvv::render {

// What a scene's materials are bound to besides their own textures. It must outlive the binding.
struct SetSurroundings {
    const SetEnvironment& environment;
    const SetLighting& lighting;
    const gpu::Buffer& volume_depth;
};

// Owns vertices, textures and materials of one scene, always those of the same one. The scene must outlive it. The
// draw_ functions are called between vkCmdBeginRendering and vkCmdEndRendering.
class SetMeshes {
  public:
    // Throws RuntimeFailure where the scene exceeds the device.
    SetMeshes(const gpu::Device& device, const stage::GltfScene& scene, const SetSurroundings& around);
    SetMeshes(const SetMeshes&) = delete;
    SetMeshes& operator=(const SetMeshes&) = delete;

    // Replaces the scene as SetRaster::change does, and returns whether shapes or surfaces are others.
    bool change(const stage::GltfScene& scene, const SetSurroundings& around, bool same_environment);
    // Binds the materials again, as what surrounds them has been replaced.
    void bind(const SetSurroundings& around);

    bool has_pose(const stage::PosedScene& pose) const { return render::has_pose(geometry_, pose); }
    // Returns whether any vertex has moved.
    bool pose(const stage::PosedScene& pose) { return pose_geometry(geometry_, pose); }
    // The bounds of all posed vertices: world, metres.
    WorldBox box() const { return {geometry_.low, geometry_.high}; }
    bool has_blended() const { return has_blended_; }

    // Draws near to far, so that few hidden fragments are shaded; masked pieces come last.
    void draw_solid(gpu::Commands& commands, const SetPush& push);
    // Draws far to near, by the centres of the primitives' boxes.
    void draw_blended(gpu::Commands& commands, const SetPush& push);
    // Draws what casts shadows.
    void draw_shadowing(gpu::Commands& commands, const SetPush& push) const;

  private:
    // What draws read, by material; the default material comes first.
    struct Surfaces {
        std::shared_ptr<SceneTextures> textures;
        gpu::Buffer materials;
        std::vector<gpu::TextureSet> solid, masked, blended, shadow;
    };
    Surfaces make_surfaces(const stage::GltfScene& scene, const SetSurroundings& around,
                           std::shared_ptr<SceneTextures> textures) const;
    void find_blended();
    void sort_far_to_near(const glm::vec3& eye);
    void draw(gpu::Commands& commands, const gpu::GraphicsPass& pass, const std::vector<gpu::TextureSet>& sets,
              const SceneDraw& draw, SetPush push) const;

    const gpu::Device& device_;
    const stage::GltfScene* scene_;
    SceneGeometry geometry_;
    gpu::GraphicsPass solid_, masked_, blended_, shadow_;
    Surfaces surfaces_;
    std::vector<std::pair<float, uint32_t>> order_;  // (−distance, index) of all draws, far to near
    bool has_blended_ = false;
};

}  // namespace neuvv::render
