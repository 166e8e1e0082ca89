// The set of a stage: a glTF scene under its lights. The rays of volumes end at it and are composited over it.
//
//     pose, light ─► record_shadows ─► record_solid ─► colour, depth
//                    (volumes, up to depth ─► volume_depth) ─► record_transparent ─► colour, front
//
// The image of a view is then `front` over the volumes over `colour`. There is one sample per texel; a frame may take
// several texels per pixel.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/set/environment.h"
#include "render/set/scene_geometry.h"
#include "render/set/set_lights.h"
#include "shared/set.h"

namespace neuvv::render {

constexpr double kSetNear_m = 0.02;  // distance of the near plane

// The environment image of a set, on the device.
struct SetEnvironment {
    // `source`: as make_environment's image; null: no light. It is not needed afterwards.
    SetEnvironment(const gpu::Device& device, const media::Image* source);

    gpu::DeviceImage image;
    gpu::Sampler sampler;
    Irradiance irradiance{};
    float last_level = 0;
    bool has_image = false;
};

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
    // Replaces the buffers `colour`, `front`, `depth` and `volume_depth`: passes that are bound to them must be created
    // again. Throws RuntimeFailure where there is no memory, and must then be called again before anything is drawn.
    void resize(uint32_t width, uint32_t height);

    // Sets the pose of the scene. Vertices that did not move are not written.
    // Whether the pose is the present one already. If not, pose() writes what draws read, and no submitted work may
    // draw the set meanwhile.
    bool has_pose(const stage::PosedScene& pose) const;
    void pose(const stage::PosedScene& pose);
    void light(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows = {});

    // Sets the parts of each view's image that nobody can see (because of a headset's lenses) until the next call. A
    // list has the corners of triangles, as fractions of the image's width and height from the upper left. Rays end
    // there at once, and nothing is shaded. There must be a list for each view, or none (assert).
    void hide(std::span<const std::vector<glm::vec2>> corners);

    // Where a height is given (world, metres), draws neither scene nor environment until the next call, but what
    // performers' shadows take of the light on a horizontal floor at this height: black, with alpha below 1. Without
    // shadow, `colour` is 0 there. Rays end at the floor.
    void catch_shadows(std::optional<double> floor_m);

    // To be recorded first: brings the lights to lights_buffer.
    void record_lights(gpu::Commands& commands) const;
    // Draws the shadow maps of the set. Records nothing where neither the set nor the lights with shadows have changed.
    void record_shadows(gpu::Commands& commands);
    // Draws opaque and masked pieces, and the environment behind them where it is shown → colour, depth. One camera per
    // view, all of the same size.
    void record_solid(gpu::Commands& commands, std::span<const stage::Camera> cameras);
    // Draws blended pieces, far to near by the centres of their primitives' boxes. What is behind volume_depth is
    // blended over `colour`, what is before it goes → front. To be recorded after record_solid with the same cameras.
    void record_transparent(gpu::Commands& commands, std::span<const stage::Camera> cameras);

    // Sets the box of the performers that cast shadows; none: no performer does. PerformerShadows calls it.
    void set_shadow_casters(const std::optional<WorldBox>& performers);

    // The first kMaxSetLights lights that light() was called with.
    std::span<const SetLight> given_lights() const { return given_lights_; }
    // The lights as shaders take them: light[i].shadow is the index of a light's map in both kinds of shadow maps.
    const ShaderLights& lights() const { return packed_; }
    // Whether blended pieces are drawn. If not, record_transparent does nothing and `front` stays 0.
    bool has_transparent() const { return has_transparent_ && !catcher_floor_m_; }
    // The bounds of all posed vertices: world, metres.
    WorldBox box() const;
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t views() const { return static_cast<uint32_t>(colours_.size()); }

    // Texel view · width · height + y · width + x, where width and height are those of the cameras that were drawn:
    gpu::Buffer colour;  // rgba16f, linear premultiplied light; alpha 0 where there is no set
    gpu::Buffer front;   // the same, of the blended pieces before the volumes
    gpu::Buffer depth;   // r32f, metres along the camera's axis; infinity where there is no opaque or masked set
    // r32f, metres along the camera's axis to the volumes; infinity where there are none, and until a pass writes it.
    gpu::Buffer volume_depth;

    gpu::Buffer lights_buffer;    // a uniform ShaderLights
    gpu::Buffer set_shadow_maps;  // r32f, kMaxShadows maps; shadow.glsl reads them
    gpu::Buffer
        performer_shadows;  // rg32f, kMaxShadows maps: alpha, metres from the light's camera; 0 until a pass writes it

  private:
    // What draws read, by material; the default material comes first.
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
    // Removes blended pieces that were drawn and no longer are.
    void clear_front(bool had_transparent);
    void pack();
    SetPush push_of(const stage::Camera& camera, uint32_t view) const;
    void record_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view);
    void record_blended_view(gpu::Commands& commands, const stage::Camera& camera, uint32_t view);
    void record_shadow(gpu::Commands& commands, const ShaderLight& light);
    void draw_hidden(gpu::Commands& commands, uint32_t view) const;
    void draw_background(gpu::Commands& commands, const stage::Camera& camera) const;
    void draw_catcher(gpu::Commands& commands, SetPush push) const;
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
    std::vector<std::pair<float, uint32_t>> order_;  // (−distance, index) of all draws, far to near
    bool has_transparent_ = false;
    bool shadows_outdated_ = true;
    // The triangles that nobody can see.
    struct Hidden {
        gpu::GraphicsPass pass;
        gpu::Buffer corners;  // of all views
        std::vector<std::pair<uint32_t, uint32_t>>
            of_view;  // (first corner, number of corners); empty: none are hidden
    };
    std::unique_ptr<Hidden> hidden_;  // null until hide() was called
    struct Catcher {
        gpu::GraphicsPass pass;
        gpu::TextureSet bound;
    };
    std::unique_ptr<Catcher> catcher_;  // null until shadows were caught
    std::optional<double> catcher_floor_m_;
};

}  // namespace neuvv::render
