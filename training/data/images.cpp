#include "training/data/images.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/platform.h"
#include "base/threads/parallel.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/plate.h"
#include "training/data/segments.h"
#include "training/data/undistort.h"

namespace neuvv::training {

namespace {

constexpr double kMinSeenShare = 0.5;  // of a pinhole image; a lens that shows less of it must be calibrated wrongly

void expect_size(media::ImageSize found, const ImageSource& source, media::ImageSize size, const std::string& whose) {
    if (found.width == size.width && found.height == size.height) return;
    throw InputError(source.path.string(), "",
                     fmt::format("is {}×{}, but {} {}×{}", found.width, found.height, whose, size.width, size.height),
                     "give all images and masks of a camera the size that its calibration is for");
}

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

// The values of a mask: its alpha where it has one, else the brightest of R, G and B.
class MaskValues {
  public:
    explicit MaskValues(const media::Image& mask) : mask_(mask) {
        for (size_t i = 3; i < mask.rgba.size() && !by_alpha_; i += 4) by_alpha_ = mask.rgba[i] != 255;
    }
    uint8_t operator[](size_t pixel) const {
        const uint8_t* at = &mask_.rgba[4 * pixel];
        return by_alpha_ ? at[3] : std::max({at[0], at[1], at[2]});
    }

  private:
    const media::Image& mask_;
    bool by_alpha_ = false;
};

void set_alpha(media::Image& image, const media::Image& matte, MaskMeaning meaning = MaskMeaning::kMatte) {
    const MaskValues values(matte);
    const bool labels = meaning == MaskMeaning::kLabels;
    for (size_t i = 0; i < image.rgba.size() / 4; ++i)
        image.rgba[4 * i + 3] = labels && values[i] != 0 ? uint8_t{255} : values[i];
}

// The pixels that a mask excludes. Any value other than 0 counts as white, as in the programs that write these masks.
std::vector<bool> ignored_by(const media::Image& mask, MaskMeaning meaning) {
    const MaskValues values(mask);
    std::vector<bool> ignored(mask.rgba.size() / 4);
    for (size_t i = 0; i < ignored.size(); ++i) ignored[i] = (values[i] != 0) == (meaning == MaskMeaning::kIgnore);
    return ignored;
}

// The folder of mattes that `neuvv matte` or a person put beside the data set.
std::filesystem::path mattes_folder(const Rig& rig) {
    return rig.folder / "mattes";
}

bool all_opaque(const media::Image& image) {
    for (size_t i = 3; i < image.rgba.size(); i += 4)
        if (image.rgba[i] != 255) return false;
    return true;
}

// Reads one camera's plate and shots.
class CameraLoader {
  public:
    CameraLoader(const Rig& rig, uint32_t camera, Dataset& dataset)
        : rig_(rig),
          from_(rig.cameras[camera]),
          camera_(camera),
          dataset_(dataset),
          size_{dataset.cameras[camera].width, dataset.cameras[camera].height},
          whose_(fmt::format("its camera {} in {} says", from_.name, rig.file)) {}

    void load(const std::vector<uint32_t>& shots) {
        // The map takes memory according to the calibration's size, so that size is checked before.
        if (from_.lens.distorts()) {
            const ImageSource& first = rig_.shots[shots.at(0)].image;
            expect_size(size_of(first), first, size_, whose_);
            map_ = undistortion();
        }
        if (!from_.plate.path.empty()) {
            media::Image& plate = dataset_.plates[camera_];
            plate = read_plate(from_.plate,
                               [&](media::ImageSize found) { expect_size(found, from_.plate, size_, whose_); });
            if (map_) plate = undistort(plate, *map_, ColourOf::kCapture);
        }
        for (const uint32_t shot : shots) load_view(rig_.shots[shot], dataset_.views[shot]);
    }

  private:
    Undistortion undistortion() const {
        interchange::Lens lens = from_.lens;
        lens.width = size_.width;
        lens.height = size_.height;
        Undistortion map = make_undistortion(lens);
        if (map.seen_share >= kMinSeenShare) return map;
        const std::string fold =
            map.fold_degrees > 0 ? fmt::format(" (it folds over {:.1f}° off the axis)", map.fold_degrees) : "";
        throw InputError(
            rig_.file, "camera " + from_.name,
            fmt::format("its lens distortion{} leaves only {:.0f} % of the image", fold, 100 * map.seen_share),
            "check the coefficients, and that focal length and size are of the same image");
    }

    media::Image read(ImageReader& reader, const ImageSource& source) const {
        return reader.read(source, [&](media::ImageSize found) { expect_size(found, source, size_, whose_); });
    }

    void load_view(const Shot& shot, View& view) {
        media::Image image = read(images_, shot.image);
        if (!shot.mask.path.empty()) {
            const media::Image mask = read(masks_, shot.mask);
            if (rig_.masks == MaskMeaning::kMatte || rig_.masks == MaskMeaning::kLabels)
                set_alpha(image, mask, rig_.masks);
            else
                view.ignored = ignored_by(mask, rig_.masks);
        }
        apply_matte_file(shot, image);
        if (map_) {
            const bool captured = dataset_.plates[camera_].width > 0;
            image = undistort(image, *map_, captured ? ColourOf::kCapture : ColourOf::kForeground);
            view.ignored = undistort_ignored(view.ignored, *map_);
        }
        for (size_t i = 0; i < view.ignored.size(); ++i)
            if (view.ignored[i]) image.rgba[4 * i + 3] = 0;
        store(view, image);
    }

    static void store(View& view, const media::Image& image) {
        try {
            view.image.store(image);
        } catch (const RuntimeFailure& failure) {
            throw RuntimeFailure(
                fmt::format("{}; point XDG_CACHE_HOME to a folder on a disk with room for these images, or "
                            "take fewer or smaller ones",
                            failure.what()));
        }
    }

    // Uses the image's file in the folder of mattes. Where that folder exists and has no such file, an opaque image is
    // an error, as all of it would count as performer.
    void apply_matte_file(const Shot& shot, media::Image& image) {
        std::error_code ignored;
        const std::filesystem::path folder = mattes_folder(rig_), file = folder / (shot.name + ".png");
        if (std::filesystem::is_regular_file(file, ignored))
            set_alpha(image, read(mattes_, {file, -1}));
        else if (std::filesystem::is_directory(folder, ignored) && all_opaque(image))
            throw InputError(file.string(), "", fmt::format("is missing: {} has no other matte", shot.name),
                             {Remedy::kMakeMattes, rig_.folder.string()});
    }

    const Rig& rig_;
    const RigCamera& from_;
    const uint32_t camera_;
    Dataset& dataset_;
    const media::ImageSize size_;
    const std::string whose_;
    std::optional<Undistortion> map_;
    ImageReader images_, masks_, mattes_;
};

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

uint64_t bytes_of(const Rig& rig, const std::vector<stage::Camera>& cameras) {
    uint64_t bytes = 0;
    for (const Shot& shot : rig.shots) bytes += uint64_t{4} * cameras[shot.camera].width * cameras[shot.camera].height;
    return bytes;
}

// Memory for the images of a rig, of which the part that exceeds the budget lies on disk.
std::shared_ptr<SpooledMemory> make_spool(const Rig& rig, const std::vector<stage::Camera>& cameras,
                                          const LoadOptions& options) {
    constexpr uint64_t kRounding = 2 * SpooledMemory::kRounding;  // an image has two arrays
    uint64_t most = 0;
    for (const Shot& shot : rig.shots)
        most += TiledImage::max_bytes(cameras[shot.camera].width, cameras[shot.camera].height) + kRounding;
    const std::filesystem::path cache = cache_folder();
    return std::make_shared<SpooledMemory>(options.memory_bytes > 0 ? options.memory_bytes : image_budget(),
                                           cache.empty() ? "/var/tmp" : cache, most);
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
    dataset.spool = make_spool(rig, dataset.cameras, options);
    for (const Shot& shot : rig.shots)
        dataset.views.push_back({shot.name, shot.camera, shot.time, TiledImage(dataset.spool.get())});
    for (const RigCamera& camera : rig.cameras) dataset.camera_names.push_back(camera.name);
    dataset.plates.resize(rig.cameras.size());
    parallel_for(rig.cameras.size(), 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) CameraLoader(rig, static_cast<uint32_t>(c), dataset).load(shots[c]);
    });
    if (options.mattes_needed) expect_matte(rig, dataset, options.may_be_empty);
    return dataset;
}

}  // namespace neuvv::training
