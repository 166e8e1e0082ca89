#include "training/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "base/platform.h"

namespace neuvv {

namespace {

constexpr uint64_t kMaxImageFileBytes = uint64_t{1} << 30;

Image read_picture(const PictureSource& source) {
    const std::vector<uint8_t> bytes = read_file(source.path, kMaxImageFileBytes);
    return decode_image(bytes.data(), bytes.size(), source.path.string());
}

void expect_size(const Image& image, const PictureSource& source, const Camera& camera, const std::string& whose) {
    if (image.width == camera.width && image.height == camera.height) return;
    throw InputError(
        source.path.string(), "",
        fmt::format("is {}×{}, but {} {}×{}", image.width, image.height, whose, camera.width, camera.height),
        "give all pictures of a camera the size that its calibration is for");
}

Camera make_camera(const RigCamera& from, const PictureSource& first_picture) {
    Camera camera;
    camera.world_from_camera = from.world_from_camera;
    camera.fx = from.lens.fx;
    camera.fy = from.lens.fy;
    camera.cx = from.lens.cx;
    camera.cy = from.lens.cy;
    const ImageSize size =
        from.lens.width ? ImageSize{from.lens.width, from.lens.height} : image_size(first_picture.path);
    camera.width = size.width;
    camera.height = size.height;
    return camera;
}

// Shots of each camera, in their order.
std::vector<std::vector<uint32_t>> shots_by_camera(const Rig& rig) {
    std::vector<std::vector<uint32_t>> result(rig.cameras.size());
    for (uint32_t i = 0; i < rig.shots.size(); ++i) result[rig.shots[i].camera].push_back(i);
    return result;
}

// One camera's plate and pictures.
void read_camera(const Rig& rig, uint32_t camera, const std::vector<uint32_t>& shots, Dataset& dataset) {
    const std::string whose = fmt::format("its camera {} in {} says", rig.cameras[camera].name, rig.file);
    const Camera& pinhole = dataset.cameras[camera];
    if (const PictureSource& plate = rig.cameras[camera].plate; !plate.path.empty()) {
        dataset.plates[camera] = read_picture(plate);
        expect_size(dataset.plates[camera], plate, pinhole, whose);
    }
    for (const uint32_t i : shots) {
        dataset.views[i].image = read_picture(rig.shots[i].picture);
        expect_size(dataset.views[i].image, rig.shots[i].picture, pinhole, whose);
    }
}

void expect_matte(const Rig& rig, const Dataset& dataset) {
    bool clear = false, solid = false;
    for (const View& view : dataset.views)
        for (size_t i = 3; i < view.image.rgba.size() && !(clear && solid); i += 4) {
            clear |= view.image.rgba[i] != 255;
            solid |= view.image.rgba[i] != 0;
        }
    if (!clear)
        throw InputError(rig.folder.string(), "", "no picture has a matte: every alpha is 255",
                         "give RGBA PNGs whose alpha is 255 on the performer and 0 elsewhere");
    if (!solid)
        throw InputError(rig.folder.string(), "", "every alpha of every picture is 0",
                         "give RGBA PNGs whose alpha is 255 on the performer and 0 elsewhere");
}

}  // namespace

Dataset read_pictures(const Rig& rig, const LoadOptions& options) {
    Dataset dataset;
    dataset.folder = rig.folder;
    dataset.box = rig.box;
    dataset.fps = rig.fps;
    const std::vector<std::vector<uint32_t>> shots = shots_by_camera(rig);
    std::set<double> times;
    for (const Shot& shot : rig.shots) {
        dataset.views.push_back({shot.name, shot.camera, shot.time, {}});
        times.insert(shot.time);
    }
    dataset.times.assign(times.begin(), times.end());
    for (size_t c = 0; c < rig.cameras.size(); ++c)
        dataset.cameras.push_back(make_camera(rig.cameras[c], rig.shots[shots[c].at(0)].picture));
    dataset.plates.resize(rig.cameras.size());
    parallel_for(rig.cameras.size(), 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) read_camera(rig, static_cast<uint32_t>(c), shots[c], dataset);
    });
    if (options.mattes_needed) expect_matte(rig, dataset);
    return dataset;
}

}  // namespace neuvv
