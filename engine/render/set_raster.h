// The set of a stage: a glTF scene under its lights, as volume rays end at it and are composited over it.
//
//     pose, light ─► record_shadows ─► record_solid ─► colour, depth
//                    (volumes, up to depth ─► volume_depth) ─► record_transparent ─► colour, front
//
// A view's image in the end: front over the volumes over colour. One sample a texel: the frame takes several texels a
// pixel.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/environment.h"
#include "render/scene_geometry.h"
#include "render/set_lights.h"
#include "shared/set.h"

namespace neuvv::render {

constexpr double kSetNear_m = 0.02;  // what is nearer to a camera's plane is cut off

// The image around a set, on the device.
struct SetEnvironment {
    // environment.h says what the image is; null: no light. It is not needed afterwards.
    SetEnvironment(const gpu::Device& device, const media::Image* source);

    gpu::DeviceImage image;
    gpu::Sampler sampler;
    Irradiance irradiance{};
    float last_level = 0;
    bool has_image = false;
};

// Draws one scene for at most `views` views of at most width × height texels. What is made here is all that it ever
// makes until it is changed: posing, lighting and recording allocate nothing. All but recording touch memory that draws
// read: nothing that was recorded here may be under way.
class SetRaster {
  public:
    // Throws RuntimeFailure where the scene exceeds the device. The scene must outlive this; the image around it need
    // not (environment.h says what it is).
    SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height, uint32_t views,
              const media::Image* environment = nullptr);
    SetRaster(const gpu::Device& device, const stage::GltfScene& scene, uint32_t width, uint32_t height, uint32_t views,
              std::shared_ptr<const SetEnvironment> environment);
    SetRaster(const SetRaster&) = delete;
    SetRaster& operator=(const SetRaster&) = delete;

    // From now on it draws this scene, which must outlive it; the one before is looked at for the last time. Pipelines
    // and images stay, and so does what is equal on the device: comparing takes as long as reading both. Must be
    // posed and lit anew. Throws RuntimeFailure where the scene exceeds the device, and then still draws the one
    // before.
    void change(const stage::GltfScene& scene, std::shared_ptr<const SetEnvironment> environment);
    // Other buffers `colour`, `front`, `depth` and `volume_depth`: who is bound to them must be made anew. Where it
    // throws (RuntimeFailure: no room) it must be called again before anything is drawn.
    void resize(uint32_t width, uint32_t height);

    // The time that is drawn; vertices that did not move are left alone.
    void pose(const stage::PosedScene& pose);
    void light(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows = {});

    // What of each view's image nobody sees (a headset's lens): triangles, by their corners in shares of its width
    // and height from the upper left. Rays end there at once, and nothing is shaded. As many lists as there are views,
    // or none; until it is called again. While nothing is drawn.
    void hide(std::span<const std::vector<glm::vec2>> corners);

    // Depth of the set as the lights with shadows see it; nothing where neither pose nor those lights changed.
    void record_shadows(gpu::Commands& commands);
    // Opaque and masked pieces, and the environment behind them where it is shown → colour, depth. One camera a view,
    // all of the same size.
    void record_solid(gpu::Commands& commands, std::span<const stage::Camera> cameras);
    // Blended pieces, far to near by the middles of their primitives' boxes: those behind volume_depth over colour, the
    // others → front. After record_solid with the same cameras.
    void record_transparent(gpu::Commands& commands, std::span<const stage::Camera> cameras);

    // The box of the performers that cast shadows; none until it is known. PerformerShadows says so.
    void set_shadow_casters(const std::optional<WorldBox>& performers);

    // As light() was given them.
    std::span<const SetLight> given_lights() const { return given_lights_; }
    // As shaders see them: .light[i].shadow is the i-th light's slot in both kinds of shadow map.
    const ShaderLights& lights() const { return packed_; }
    // Whether anything is blended: else record_transparent does nothing, and `front` stays 0.
    bool has_transparent() const { return has_transparent_; }
    // World, metres: the box of all that is posed.
    WorldBox box() const;
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t views() const { return static_cast<uint32_t>(colours_.size()); }

    // Texel view · width · height + y · width + x, with the size of the cameras that were drawn:
    gpu::Buffer colour;  // rgba16f, linear premultiplied light; alpha 0 where there is no set
    gpu::Buffer front;   // the same of the blended pieces before the volumes
    gpu::Buffer depth;   // r32f, metres along the camera's axis; infinity where there is no opaque or masked set
    // r32f, metres along the axis at which a texel's volume is; infinity: none, and until somebody writes it.
    gpu::Buffer volume_depth;

    gpu::Buffer lights_buffer;      // a uniform ShaderLights
    gpu::Buffer set_shadow_maps;    // r32f, kMaxShadows maps: shadow.glsl reads them
    gpu::Buffer performer_shadows;  // rg32f, kMaxShadows maps: alpha, metres from its eye; 0 until somebody writes it

  private:
    // Materials and what they read, by material, the default one first.
    struct Surfaces {
        std::shared_ptr<SceneTextures> textures;
        gpu::Buffer materials;
        std::vector<gpu::TextureSet> solid, masked, blended, shadow;
        gpu::TextureSet background;
    };
    void make_targets(uint32_t views);
    void make_images(uint32_t views);
    void make_light_buffers();
    Surfaces make_surfaces(const stage::GltfScene& scene, const SetEnvironment& environment,
                           std::shared_ptr<SceneTextures> textures) const;
    void find_transparent();
    void pack();
    SetPush push_of(const stage::Camera& camera, uint32_t view) const;
    void record_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view);
    void record_blended_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view);
    void record_shadow(gpu::Commands& commands, const ShaderLight& light);
    void draw_hidden(gpu::Commands& commands, uint32_t view) const;
    void draw_background(gpu::Commands& commands, const stage::Camera& camera) const;
    void sort_far_to_near(const glm::vec3& eye);
    void draw_solid(gpu::Commands& commands, const SetPush& push);
    void draw_blended(gpu::Commands& commands, const SetPush& push);
    void draw_shadowing(gpu::Commands& commands, const SetPush& push) const;
    void draw(gpu::Commands& commands, const gpu::GraphicsPass& pass, const std::vector<gpu::TextureSet>& sets,
              const SceneDraw& draw, SetPush push) const;

    const gpu::Device& device_;
    const stage::GltfScene* scene_;
    uint32_t width_, height_;
    SceneGeometry geometry_;
    gpu::GraphicsPass solid_, masked_, blended_, shadow_, background_;
    std::vector<gpu::DeviceImage> colours_, depths_;  // by view
    gpu::DeviceImage metres_, front_, shadow_depth_;
    std::shared_ptr<const SetEnvironment> environment_;
    Surfaces surfaces_;
    std::vector<SetLight> given_lights_;
    SetAmbient ambient_;
    SetShadows shadows_;
    std::optional<WorldBox> performers_;
    ShaderLights packed_{};
    std::vector<std::pair<float, uint32_t>> order_;  // of all draws, far to near: −distance, index
    bool has_transparent_ = false;
    bool shadows_outdated_ = true;
    struct Hidden {
        gpu::GraphicsPass pass;
        gpu::Buffer corners;                                 // of all views
        std::vector<std::pair<uint32_t, uint32_t>> of_view;  // first corner, how many; none: all is seen
    };
    std::unique_ptr<Hidden> hidden_;  // null until something was hidden
};

}  // namespace neuvv::render
