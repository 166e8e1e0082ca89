#include "training/mattes/swapped_images.h"

#include <algorithm>
#include <set>

#include "base/threads/parallel.h"
#include "training/mattes/working_size.h"
#include "training/tree/camera_check.h"
#include "training/tree/misfits.h"

namespace neuvv::training {

namespace {

constexpr size_t kLooksOfReader = 5;

// Its mattes are what differs from the cameras' backgrounds.
Dataset look_of(const std::vector<CameraShots>& cameras, const std::vector<CameraBackground>& backgrounds,
                const MatteSettings& settings) {
    std::set<double> all;
    for (const CameraShots& camera : cameras)
        for (const Shot* shot : camera.shots) all.insert(shot->time);
    Dataset look;
    look.folder = cameras.front().rig->folder;
    look.box = cameras.front().rig->box;
    look.times = look_times({all.begin(), all.end()});
    look.plates.resize(cameras.size());
    std::vector<WorkingCamera> working;
    std::vector<const Shot*> shots;
    for (uint32_t c = 0; c < cameras.size(); ++c) {
        const media::Image& background = backgrounds[c].image;
        working.push_back(working_camera(cameras[c].calibration(), {background.width, background.height}));
        look.cameras.push_back(working[c].camera);
        for (const Shot* shot : cameras[c].shots) {
            if (!std::ranges::binary_search(look.times, shot->time)) continue;
            look.views.push_back({shot->name, c, shot->time, TiledImage()});
            shots.push_back(shot);
        }
    }
    // The shots of a camera, which may be frames of one video, follow each other.
    parallel_for(shots.size(), kLooksOfReader, [&](size_t begin, size_t end) {
        ImageReader reader;
        for (size_t i = begin; i < end; ++i) {
            View& view = look.views[i];
            const WorkingCamera& camera = working[view.camera];
            const media::Image read = cameras[view.camera].read(reader, shots[i]->image);
            const media::Image& background = backgrounds[view.camera].image;
            // Where mattes are made, that is an error.
            if (read.width != background.width || read.height != background.height) continue;
            media::Image image = working_image(camera, read);
            const BackgroundKind kind = kind_of_background(backgrounds[view.camera].is_clean);
            const PixelMask figure = differing_pixels(image, working_image(camera, background), kind, settings);
            const PixelMask unseen = unseen_pixels(camera);
            for (size_t k = 0; k < figure.size(); ++k) image.rgba[4 * k + 3] = figure[k] && !unseen[k] ? 255 : 0;
            view.ignored.assign(unseen.set.begin(), unseen.set.end());
            view.image.store(image);
        }
    });
    std::erase_if(look.views, [](const View& view) { return view.image.width() == 0; });
    return look;
}

}  // namespace

std::vector<std::string> swap_images_back(std::vector<CameraShots>& cameras, std::vector<CameraBackground>& backgrounds,
                                          const MatteSettings& settings) {
    std::vector<std::string> said;
    if (most_misfits(cameras.size()) == 0) return said;
    for (const SwappedCameras& pair : find_misfits(look_of(cameras, backgrounds, settings)).swapped) {
        std::swap(cameras[pair.a].shots, cameras[pair.b].shots);
        std::swap(backgrounds[pair.a], backgrounds[pair.b]);
        said.push_back(swap_text(pair, cameras[pair.a].name(), cameras[pair.b].name()) +
                       ". Their mattes are made as if they were swapped back: exchange the names of their images or "
                       "videos, and of their plates, and make the mattes again");
    }
    return said;
}

}  // namespace neuvv::training
