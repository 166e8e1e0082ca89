#include "training/mattes/surroundings.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "training/data/camera_images.h"
#include "training/data/images.h"
#include "training/data/plate.h"
#include "training/data/reduce.h"
#include "training/mattes/camera_shots.h"
#include "training/tree/surroundings_tree.h"

namespace neuvv::training {

namespace {

// Pixels so near to the performer's are not used: mattes are not exact, and lenses blur.
constexpr uint32_t kMarginPixels = 3;
constexpr uint8_t kPerformerAlpha = 8;
// An image whose colours differ by no more steps of 255 shows nothing.
constexpr int kOneColour = 4;
constexpr uint32_t kSideOfLook = 64;  // pixels of an image that is only looked at for that

// The shots of a camera whose median is taken, spread evenly.
std::vector<const Shot*> shots_of(const Rig& rig, uint32_t camera) {
    std::vector<const Shot*> all, some;
    for (const Shot& shot : rig.shots)
        if (shot.camera == camera) all.push_back(&shot);
    const size_t count = std::min<size_t>(all.size(), kMaxMedianFrames);
    for (size_t i = 0; i < count; ++i) some.push_back(all[count > 1 ? i * (all.size() - 1) / (count - 1) : 0]);
    return some;
}

// Along a line of `count` flags, `stride` apart: each flag becomes whether one within the margin is set.
void widen(std::vector<bool>& flags, size_t first, size_t stride, uint32_t count) {
    std::vector<bool> line(count);
    for (uint32_t i = 0; i < count; ++i) line[i] = flags[first + i * stride];
    for (uint32_t i = 0; i < count; ++i) {
        if (!line[i]) continue;
        for (uint32_t k = i - std::min(i, kMarginPixels); k <= std::min(i + kMarginPixels, count - 1); ++k)
            flags[first + k * stride] = true;
    }
}

// Makes an image's alpha 255 where it shows the surroundings, and 0 where it shows the performer, or nothing is known.
media::Image keep_surroundings(CameraImage read, bool with_mattes) {
    media::Image& image = read.image;
    std::vector<bool> hidden(size_t{image.width} * image.height);
    for (size_t i = 0; with_mattes && i < hidden.size(); ++i) hidden[i] = image.rgba[4 * i + 3] >= kPerformerAlpha;
    for (uint32_t y = 0; with_mattes && y < image.height; ++y) widen(hidden, size_t{y} * image.width, 1, image.width);
    for (uint32_t x = 0; with_mattes && x < image.width; ++x) widen(hidden, x, image.width, image.height);
    for (size_t i = 0; i < hidden.size(); ++i) {
        const bool ignored = !read.ignored.empty() && read.ignored[i];
        const bool is_beyond_lens = !with_mattes && image.rgba[4 * i + 3] == 0;
        image.rgba[4 * i + 3] = hidden[i] || ignored || is_beyond_lens ? 0 : 255;
    }
    return std::move(image);
}

// Makes an image of known and unknown pixels smaller by a whole factor.
media::Image smaller(const media::Image& image, uint32_t factor) {
    media::Image small = reduced(image, factor);
    for (size_t i = 0; i < small.rgba.size(); i += 4)
        if (small.rgba[i + 3] != 255) std::fill_n(&small.rgba[i], 4, uint8_t{0});
    return small;
}

// By pixel the median of the images in which its alpha is not 0.
media::Image median_of_known(const std::vector<media::Image>& images) {
    media::Image median(images[0].width, images[0].height);
    std::array<std::vector<uint8_t>, 3> values;
    for (size_t i = 0; i < median.rgba.size(); i += 4) {
        for (std::vector<uint8_t>& channel : values) channel.clear();
        for (const media::Image& image : images)
            if (image.rgba[i + 3] != 0)
                for (size_t c = 0; c < 3; ++c) values[c].push_back(image.rgba[i + c]);
        if (values[0].empty()) continue;
        for (size_t c = 0; c < 3; ++c) {
            const auto middle = values[c].begin() + static_cast<ptrdiff_t>(values[c].size() / 2);
            std::nth_element(values[c].begin(), middle, values[c].end());
            median.rgba[i + c] = *middle;
        }
        median.rgba[i + 3] = 255;
    }
    return median;
}

// Why the camera's plate is not used; nothing where it is, or where there is none.
std::optional<Note> wrong_plate_of(const Rig& rig, uint32_t camera) {
    CameraShots shots{&rig, camera, {}};
    for (const Shot& shot : rig.shots)
        if (shot.camera == camera) shots.shots.push_back(&shot);
    if (shots.calibration().plate.path.empty()) return std::nullopt;
    const CameraBackground background = background_of(shots);
    return background.is_clean ? std::nullopt : std::optional(background.wrong_plate);
}

struct Surroundings {
    media::Image image;  // alpha 0 where nothing is known
    std::optional<Note> wrong_plate;
};

Surroundings surroundings_of(const Rig& rig, uint32_t camera, const stage::Camera& pinhole, bool with_mattes,
                             uint32_t factor) {
    CameraImages images(rig, camera, pinhole);
    const std::vector<const Shot*> shots = shots_of(rig, camera);
    const std::optional<Note> wrong_plate = wrong_plate_of(rig, camera);
    if (images.plate().width > 0 && !wrong_plate) {
        CameraImage plate{images.plate(), images.read(*shots[0]).ignored};
        return {smaller(keep_surroundings(std::move(plate), false), factor), {}};
    }
    std::vector<media::Image> seen;
    for (const Shot* shot : shots)
        seen.push_back(smaller(keep_surroundings(images.read(*shot, Background::kCaptured), with_mattes), factor));
    return {seen.size() == 1 ? std::move(seen[0]) : median_of_known(seen), wrong_plate};
}

uint32_t factor_of(const stage::Camera& camera, uint32_t longest) {
    return std::max(std::max(camera.width, camera.height) / std::max(longest, 1u) / 2, 1u);
}

// Ignores the pixels of which nothing is known.
View view_of(const std::string& name, uint32_t camera, const media::Image& image, SpooledMemory& spool) {
    View view{name, camera, 0, TiledImage(&spool)};
    std::vector<bool> unknown(image.rgba.size() / 4);
    for (size_t i = 0; i < unknown.size(); ++i) unknown[i] = image.rgba[4 * i + 3] == 0;
    if (std::ranges::find(unknown, true) != unknown.end()) view.ignored = std::move(unknown);
    view.image.store(image);
    return view;
}

void expect_colours(const Rig& rig, const std::vector<View>& views) {
    std::array<int, 3> least{255, 255, 255}, most{};
    for (const View& view : views)
        view.image.for_each_kept([&](uint32_t, uint32_t, const uint8_t* rgba) {
            for (size_t c = 0; rgba[3] != 0 && c < 3; ++c) {
                least[c] = std::min(least[c], int{rgba[c]});
                most[c] = std::max(most[c], int{rgba[c]});
            }
        });
    for (size_t c = 0; c < 3; ++c)
        if (most[c] - least[c] > kOneColour) return;
    throw InputError(rig.folder.string(), "", "the images show nothing outside the mattes: they were cut out",
                     "give the images as the cameras took them, with mattes in files of their own");
}

// The rig with the first image of each camera alone.
Rig with_first_images(Rig rig) {
    std::vector<bool> is_seen(rig.cameras.size());
    std::erase_if(rig.shots, [&](const Shot& shot) {
        const bool was_seen = is_seen[shot.camera];
        is_seen[shot.camera] = true;
        return was_seen;
    });
    return rig;
}

}  // namespace

bool has_mattes(const Rig& rig) {
    return has_mattes(read_images(with_first_images(rig), {.mattes_needed = false}));
}

void expect_surroundings(const Rig& rig) {
    const Dataset small = read_surroundings(with_first_images(rig), {}, kSideOfLook);
    surroundings_tree(small, leaf_pixels_of(small, kSideOfLook), 0);
}

Dataset read_surroundings(const Rig& rig, const LoadOptions& options, uint32_t longest) {
    const bool with_mattes = has_mattes(rig);
    Dataset dataset;
    dataset.folder = rig.folder;
    dataset.format = rig.format;
    dataset.box = rig.box;
    dataset.frame = rig.frame;
    dataset.fps = rig.fps;
    dataset.times = {0};
    const std::vector<stage::Camera> cameras = cameras_of(rig);
    for (const stage::Camera& camera : cameras) dataset.cameras.push_back(reduced(camera, factor_of(camera, longest)));
    for (const RigCamera& camera : rig.cameras) dataset.camera_names.push_back(camera.name);
    dataset.plates.resize(cameras.size());
    dataset.spool = make_spool(rig, options);
    dataset.views.resize(cameras.size());
    std::vector<std::optional<Note>> wrong_plates(cameras.size());
    parallel_for(cameras.size(), 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            const auto camera = static_cast<uint32_t>(c);
            Surroundings found = surroundings_of(rig, camera, cameras[c], with_mattes, factor_of(cameras[c], longest));
            wrong_plates[c] = std::move(found.wrong_plate);
            dataset.views[c] = view_of(rig.cameras[c].name, camera, found.image, *dataset.spool);
        }
    });
    for (const std::optional<Note>& plate : wrong_plates)
        if (plate) dataset.remarks.push_back(plate->words());
    expect_colours(rig, dataset.views);
    return dataset;
}

}  // namespace neuvv::training
