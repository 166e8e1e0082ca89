#include "training/data/dataset_hash.h"

#include <xxhash.h>

#include <bit>
#include <memory>

namespace neuvv::training {

uint64_t hash_of(const Dataset& dataset) {
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_64bits_reset(state.get());
    const auto add = [&](uint64_t value) { XXH3_64bits_update(state.get(), &value, sizeof(value)); };
    const auto add_image = [&](uint32_t width, uint32_t height, const std::pmr::vector<uint8_t>& rgba) {
        add(width);
        add(height);
        for (size_t i = 0; i < rgba.size(); i += 101) add(rgba[i]);
    };
    const auto add_number = [&](double value) { add(std::bit_cast<uint64_t>(value)); };
    for (const stage::Camera& camera : dataset.cameras) {
        for (int i = 0; i < 12; ++i) add_number(camera.world_from_camera[i / 3][i % 3]);
        for (const double number : {camera.fx, camera.fy, camera.cx, camera.cy}) add_number(number);
    }
    for (const View& view : dataset.views) {
        add(view.camera);
        add_number(view.time);
        add_image(view.image.width(), view.image.height(), view.image.kept_rgba());
        for (const TiledImage::Group& group : view.image.groups()) add(group.kept);
        for (size_t i = 0; i < view.ignored.size(); i += 101) add(view.ignored[i]);
    }
    for (const media::Image& plate : dataset.plates) add_image(plate.width, plate.height, plate.rgba);
    return XXH3_64bits_digest(state.get());
}

}  // namespace neuvv::training
