// The scene on which gradients are checked: a random tree, some tiles of two cameras, random truths. Also functions
// that get the device's gradients for it.
#pragma once

#include <cstring>

#include "reference/trace.h"
#include "support/random_tree.h"
#include "training/step/step.h"

namespace neuvv::test {

struct Scene {
    voctree::VOctree tree;
    std::vector<stage::Camera> cameras;
    std::vector<Tile> tiles;
    std::vector<glm::vec4> target, background;  // as in LossBatch
    float frame = 1.3f;                         // between two rows
    LossWeights weights = [] {
        LossWeights each{};
        each.grad = 0.1f;
        each.point = 0.3f;
        return each;
    }();
    float stop = 0;  // 0: rays never end early
};

struct SceneOptions {
    RandomTreeOptions tree;
    float density = 1;  // factor on every σ
    float stop = 0;
};

Scene random_scene(const SceneOptions& options);

// The same scene with other tiles and other random truths: `count` of the tiles of both cameras, beginning with `from`.
Scene with_tiles(Scene scene, size_t from, size_t count, uint64_t seed);

// Settings of a step on the scene that moves rows, too; learning rates are 0.
training::StepSettings settings_of(const Scene& scene);

// The ray of a lane of one of the scene's tiles, jitter included.
reference::Ray ray_of(const Scene& scene, const Tile& tile, uint32_t lane);

// Writes the scene into the rays() and batch() of a step of any kind.
template <typename Step>
void load_scene(const Step& step, const Scene& scene) {
    for (size_t i = 0; i < scene.cameras.size(); ++i)
        step.rays().cameras.template as<ShaderCamera>()[i] = render::shader_camera(scene.cameras[i]);
    std::memcpy(step.rays().tiles.mapped, scene.tiles.data(), scene.tiles.size() * sizeof(Tile));
    std::memcpy(step.batch().target.mapped, scene.target.data(), scene.target.size() * sizeof(glm::vec4));
    std::memcpy(step.batch().background.mapped, scene.background.data(), scene.background.size() * sizeof(glm::vec4));
}

struct Gradients {
    std::vector<float> weights;  // in planes
    std::vector<float> rows;     // those of A, then those of B
};
// The gradients of one step with AdamSettings::emit_only. The moments are restored afterwards.
Gradients emitted_gradients(const gpu::Device& device, training::TrainingStep& step, const Scene& scene);

std::vector<float> download_floats(const gpu::Device& device, const gpu::Buffer& buffer, size_t count);

// The index, among weights in planes, of number `weight` of a leaf's weights (voctree.h).
size_t index_in_planes(const voctree::VOctree& tree, uint32_t leaf, uint32_t weight);

}  // namespace neuvv::test
