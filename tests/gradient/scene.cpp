#include "gradient/scene.h"

#include <glm/gtc/packing.hpp>

#include "gpu/host_copies.h"
#include "support/look_at.h"

#include "reference/camera.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kWidth = 21, kHeight = 19;  // tiles at the right and at the bottom extend beyond the image

glm::vec3 random_rgb(Random& random, double low, double high) {
    const auto next = [&] { return static_cast<float>(random.uniform(low, high)); };
    const float r = next(), g = next(), b = next();
    return {r, g, b};
}

}  // namespace

Scene with_tiles(Scene scene, size_t from, size_t count, uint64_t seed) {
    std::vector<Tile> all = render::tiles_of_image(0, kWidth, kHeight);
    for (const Tile& tile : render::tiles_of_image(1, kWidth, kHeight)) all.push_back(tile);
    scene.tiles.clear();
    scene.target.clear();
    scene.background.clear();
    Random random(seed);
    for (size_t i = 0; i < count; ++i) {
        Tile tile = all[(from + i) % all.size()];
        const double right = random.uniform(-0.5, 0.5), down = random.uniform(-0.5, 0.5);
        tile.jitter = glm::packSnorm2x16(glm::vec2(right, down));
        scene.tiles.push_back(tile);
        for (uint32_t lane = 0; lane < kTilePixels; ++lane) {
            const bool inside = tile.x + lane % kTile < kWidth && tile.y + lane / kTile < kHeight;
            const double kind = random.uniform();
            const double alpha = kind < 0.2 ? 0 : kind > 0.8 ? 1 : random.uniform();
            const glm::vec3 colour = static_cast<float>(alpha) * random_rgb(random, 0, 1);
            scene.target.emplace_back(colour, inside ? static_cast<float>(alpha) : -1.0f);
            scene.background.emplace_back(random_rgb(random, 0.05, 0.9), 0.0f);
        }
    }
    return scene;
}

Scene random_scene(const SceneOptions& options) {
    Scene scene;
    scene.tree = random_tree(options.tree);
    for (uint32_t leaf = 0; leaf < scene.tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < scene.tree.bases; ++c) scene.tree.leaf(leaf)[c] *= options.density;
    const glm::dvec3 centre = glm::dvec3(scene.tree.box_min) + 0.5 * glm::dvec3(scene.tree.box_size);
    scene.cameras = {look_at(centre + glm::dvec3(1.9, 1.2, 2.4), centre, kWidth, kHeight, 1.2),
                     look_at(centre + glm::dvec3(-2.3, 0.4, 1.3), centre, kWidth, kHeight, 1.0)};
    scene.stop = options.stop;
    return with_tiles(std::move(scene), 3, 7, options.tree.seed + 100);
}

training::StepSettings settings_of(const Scene& scene) {
    training::StepSettings settings;
    settings.frame = scene.frame;
    settings.tiles = static_cast<uint32_t>(scene.tiles.size());
    settings.weights = scene.weights;
    settings.stop = scene.stop;
    settings.learn_rows = true;
    return settings;
}

reference::Ray ray_of(const Scene& scene, const Tile& tile, uint32_t lane) {
    const glm::dvec2 jitter(glm::unpackSnorm2x16(tile.jitter));
    return reference::camera_ray(scene.cameras[tile.camera], tile.x + lane % kTile + jitter.x,
                                 tile.y + lane / kTile + jitter.y);
}

std::vector<float> download_floats(const gpu::Device& device, const gpu::Buffer& buffer, size_t count) {
    std::vector<float> values(count);
    gpu::download(device, buffer, values.data(), count * sizeof(float));
    return values;
}

Gradients emitted_gradients(const gpu::Device& device, training::TrainingStep& step, const Scene& scene) {
    const training::Moments& moments = step.moments();
    const size_t count = size_t{4} * step.field().planes() * scene.tree.leaf_count;
    const size_t rows = size_t{2} * scene.tree.frames * scene.tree.bases;
    const std::vector<float> first = download_floats(device, moments.first, count);
    const std::vector<float> rows_first = download_floats(device, moments.rows_first, rows);
    gpu::run_once(device, "clear moments", [&](gpu::Commands& commands) {
        gpu::fill(commands, moments.first, 0);
        gpu::fill(commands, moments.rows_first, 0);
    });
    load_scene(step, scene);
    training::StepSettings settings = settings_of(scene);
    settings.adam.emit_only = true;
    step.submit(settings);
    step.wait();
    Gradients gradients{download_floats(device, moments.first, count),
                        download_floats(device, moments.rows_first, rows)};
    gpu::upload(device, moments.first, first.data(), count * sizeof(float));
    gpu::upload(device, moments.rows_first, rows_first.data(), rows * sizeof(float));
    return gradients;
}

size_t index_in_planes(const voctree::VOctree& tree, uint32_t leaf, uint32_t weight) {
    const uint32_t basis_planes = (tree.bases + 3) / 4, functions = hh_count(tree.hh_degree);
    uint32_t plane, part;
    if (weight < 2 * tree.bases) {
        const uint32_t c = weight % tree.bases;
        plane = c / 4 + (weight < tree.bases ? 0 : basis_planes);
        part = c % 4;
    } else {
        plane = 2 * basis_planes + (weight - 2 * tree.bases) % functions;
        part = (weight - 2 * tree.bases) / functions;
    }
    return (size_t{plane} * tree.leaf_count + leaf) * 4 + part;
}

}  // namespace neuvv::test
