#include "training/data/images.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "training/data/camera_images.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/segments.h"

namespace neuvv::training {

namespace {

stage::Camera make_camera(const RigCamera& from, media::ImageSize size) {
    stage::Camera camera;
    camera.world_from_camera = from.world_from_camera;
    camera.fx = from.lens.fx;
    camera.fy = from.lens.fy;
    camera.cx = from.lens.cx;
    camera.cy = from.lens.cy;
    camera.width = size.width;
    camera.height = size.height;
    return camera;
}

void store(View& view, const media::Image& image) {
    try {
        view.image.store(image);
    } catch (const RuntimeFailure& failure) {
        throw RuntimeFailure(
            fmt::format("{}; point XDG_CACHE_HOME to a folder on a disk with room for these images, or "
                        "take fewer or smaller ones",
                        failure.what()));
    }
}

uint64_t bytes_of(const Rig& rig, const std::vector<stage::Camera>& cameras) {
    uint64_t bytes = 0;
    for (const Shot& shot : rig.shots) bytes += uint64_t{4} * cameras[shot.camera].width * cameras[shot.camera].height;
    return bytes;
}

void expect_matte(const Rig& rig, const Dataset& dataset, bool may_be_empty) {
    bool clear = false, solid = false;
    for (const View& view : dataset.views)
        for (uint32_t y = 0; y < view.image.height() && !(clear && solid); ++y)
            for (uint32_t x = 0; x < view.image.width(); ++x) {
                if (view.ignores(x, y)) continue;
                clear |= view.image.at(x, y)[3] != 255;
                solid |= view.image.at(x, y)[3] != 0;
            }
    const std::string folder = rig.folder.string();
    if (!clear)
        throw InputError(folder, "", "no image has a matte: every alpha is 255", {Remedy::kMakeMattesOrGive, folder});
    if (!solid && !may_be_empty)
        throw InputError(folder, "", "every alpha of every image is 0",
                         "give RGBA PNGs whose alpha is 255 on the performer and 0 elsewhere");
}

}  // namespace

std::shared_ptr<SpooledMemory> make_spool(const Rig& rig, const LoadOptions& options) {
    constexpr uint64_t kRounding = 2 * SpooledMemory::kRounding;  // an image has two arrays
    const std::vector<stage::Camera> cameras = cameras_of(rig);
    uint64_t most = 0;
    for (const Shot& shot : rig.shots)
        most += TiledImage::max_bytes(cameras[shot.camera].width, cameras[shot.camera].height) + kRounding;
    const std::filesystem::path cache = cache_folder();
    return std::make_shared<SpooledMemory>(options.memory_bytes > 0 ? options.memory_bytes : image_budget(),
                                           cache.empty() ? "/var/tmp" : cache, most);
}

std::vector<stage::Camera> cameras_of(const Rig& rig) {
    std::vector<const Shot*> first(rig.cameras.size());
    for (const Shot& shot : rig.shots)
        if (!first[shot.camera]) first[shot.camera] = &shot;
    std::vector<stage::Camera> cameras;
    for (size_t c = 0; c < rig.cameras.size(); ++c) {
        const interchange::Lens& lens = rig.cameras[c].lens;
        const media::ImageSize size = lens.width ? media::ImageSize{lens.width, lens.height} : size_of(first[c]->image);
        cameras.push_back(make_camera(rig.cameras[c], size));
    }
    return cameras;
}

ImageCount image_count(const Rig& rig) {
    const std::vector<stage::Camera> cameras = cameras_of(rig);
    ImageCount count{.images = rig.shots.size(), .cameras = cameras.size(), .bytes = bytes_of(rig, cameras)};
    count.frames = times_of(rig).size();
    for (const stage::Camera& camera : cameras) {
        count.width = std::max(count.width, camera.width);
        count.height = std::max(count.height, camera.height);
    }
    return count;
}

Dataset read_images(const Rig& rig, const LoadOptions& options) {
    Dataset dataset;
    dataset.folder = rig.folder;
    dataset.format = rig.format;
    dataset.box = rig.box;
    dataset.frame = rig.frame;
    dataset.remarks = rig.remarks;
    dataset.fps = rig.fps;
    dataset.times = times_of(rig);
    std::vector<std::vector<uint32_t>> shots(rig.cameras.size());  // indices into rig.shots by camera
    for (uint32_t i = 0; i < rig.shots.size(); ++i) shots[rig.shots[i].camera].push_back(i);
    dataset.cameras = cameras_of(rig);
    dataset.spool = make_spool(rig, options);
    for (const Shot& shot : rig.shots)
        dataset.views.push_back({shot.name, shot.camera, shot.time, TiledImage(dataset.spool.get())});
    for (const RigCamera& camera : rig.cameras) dataset.camera_names.push_back(camera.name);
    dataset.plates.resize(rig.cameras.size());
    parallel_for(rig.cameras.size(), 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            CameraImages images(rig, static_cast<uint32_t>(c), dataset.cameras[c]);
            dataset.plates[c] = images.plate();
            for (const uint32_t shot : shots[c]) {
                CameraImage read = images.read(rig.shots[shot]);
                store(dataset.views[shot], read.image);
                dataset.views[shot].ignored = std::move(read.ignored);
            }
        }
    });
    if (options.mattes_needed) expect_matte(rig, dataset, options.may_be_empty);
    return dataset;
}

}  // namespace neuvv::training
