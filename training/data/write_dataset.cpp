#include "training/data/write_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "base/threads/parallel.h"
#include "media/image.h"
#include "training/data/both_splits.h"
#include "training/data/camera_images.h"
#include "training/data/images.h"
#include "training/data/mask_image.h"
#include "training/data/matte_sources.h"
#include "training/data/reduce.h"
#include "training/data/transforms_file.h"

namespace neuvv::training {

namespace {

std::string file_name(std::string name) {
    std::ranges::replace(name, '/', '_');
    return name;
}

// What each image is called: what its name has from its camera's name on, so that readers, who call cameras by what the
// names of their images have in common, call them as here. Where that makes two names one, images keep theirs.
using ImageNames = std::map<const Shot*, std::string>;
ImageNames image_names(const std::vector<Rig>& rigs) {
    ImageNames names;
    std::map<std::string, std::string> from;  // the images' own names, by the new ones
    bool distinct = true;
    for (const Rig& rig : rigs)
        for (const Shot& shot : rig.shots) {
            const size_t at = ("_" + shot.name).rfind("_" + file_name(rig.cameras[shot.camera].name) + "_");
            names[&shot] = at == std::string::npos ? shot.name : shot.name.substr(at);
            distinct = distinct && from.try_emplace(names[&shot], shot.name).first->second == shot.name;
        }
    if (!distinct)
        for (auto& [shot, name] : names) name = shot->name;
    return names;
}

// The file of each camera's plate, by the camera's name. Where "a/b" would get that of "a_b", it gets one of its own.
using PlateNames = std::map<std::string, std::string>;
PlateNames plate_names(const std::vector<Rig>& rigs) {
    PlateNames names;
    for (const Rig& rig : rigs)
        for (const RigCamera& camera : rig.cameras) names[camera.name] = file_name(camera.name);
    std::set<std::string> taken;
    for (const auto& [camera, file] : names)
        if (camera == file) taken.insert(file);
    for (auto& [camera, file] : names) {
        if (camera == file) continue;
        while (!taken.insert(file).second) file += "_";
    }
    return names;
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

// Whether pixels may be ignored: those that masks exclude, and those that a lens with distortion never saw.
bool may_ignore(const std::vector<Rig>& rigs) {
    return std::ranges::any_of(rigs, [](const Rig& rig) {
        const bool excludes = rig.masks == MaskMeaning::kUsable || rig.masks == MaskMeaning::kIgnore;
        return std::ranges::any_of(rig.cameras, [](const RigCamera& camera) { return camera.lens.distorts(); }) ||
               (excludes && std::ranges::any_of(rig.shots, [](const Shot& shot) { return !shot.mask.path.empty(); }));
    });
}

// Counts images as done, on several threads.
class Count {
  public:
    Count(const WriteProgress& progress, uint64_t total) : progress_(progress), total_(total) {}
    bool stopped() const { return stopped_; }
    void add() {
        const std::scoped_lock lock(mutex_);
        ++done_;
        if (progress_ && !progress_(done_, total_)) stopped_ = true;
    }

  private:
    const WriteProgress& progress_;
    const uint64_t total_;
    uint64_t done_ = 0;
    std::atomic<bool> stopped_ = false;
    std::mutex mutex_;
};

// Writes the images of one split.
class SplitWriter {
  public:
    SplitWriter(const std::filesystem::path& output, const WriteSummary& summary, const Rig& rig,
                const ImageNames& names, const PlateNames& plates, Count& count, uint32_t reduction)
        : output_(output),
          summary_(summary),
          rig_(rig),
          names_(names),
          plates_(plates),
          cameras_(cameras_of(rig)),
          count_(count),
          reduction_(reduction) {
        for (size_t c = 0; c < cameras_.size(); ++c)
            if (std::min(cameras_[c].width, cameras_[c].height) < reduction)
                throw InputError(rig.file, rig.cameras[c].name,
                                 fmt::format("has images of {}×{}, too small to be reduced {} times", cameras_[c].width,
                                             cameras_[c].height, reduction));
    }

    // Those that are in `written` are there already, as those of the validation are often those of the test. Adds the
    // others to it.
    void write_images(std::set<std::string>& written) {
        std::vector<std::vector<const Shot*>> shots(rig_.cameras.size());
        for (const Shot& shot : rig_.shots)
            if (written.insert(names_.at(&shot)).second) shots[shot.camera].push_back(&shot);
        parallel_for(shots.size(), 1, [&](size_t begin, size_t end) {
            for (size_t c = begin; c < end && !count_.stopped(); ++c) write_camera(c, shots[c]);
        });
    }
    void write_file(const std::filesystem::path& file) const {
        std::vector<stage::Camera> cameras;
        for (const stage::Camera& camera : cameras_) {
            cameras.push_back(reduced(camera, reduction_));
            cameras.back().world_from_camera = rig_.frame.pose_to_capture(camera.world_from_camera);
        }
        WrittenTransforms transforms{cameras, {}, rig_.box, rig_.fps, kWrittenBy};
        if (rig_.box)
            transforms.box = {rig_.frame.to_capture(rig_.box->first), rig_.frame.to_capture(rig_.box->second)};
        for (const Shot& shot : rig_.shots) {
            const RigCamera& camera = rig_.cameras[shot.camera];
            const std::string image = names_.at(&shot) + ".png";
            transforms.frames.push_back({shot.camera, shot.time, "images/" + image,
                                         camera.plate.path.empty() ? "" : "plates/" + plates_.at(camera.name) + ".png",
                                         summary_.masks ? "masks/" + image : ""});
        }
        write_transforms_file(file, transforms);
    }

  private:
    void write_camera(size_t c, const std::vector<const Shot*>& shots) {
        CameraImages images(rig_, static_cast<uint32_t>(c), cameras_[c]);
        if (images.plate().width > 0)
            write("plates", plates_.at(rig_.cameras[c].name), reduced(images.plate(), reduction_));
        for (const Shot* shot : shots) {
            if (count_.stopped()) return;
            const CameraImage read = images.read(*shot, Background::kCaptured);
            const media::Image image = reduced(read.image, reduction_);
            const std::vector<bool> ignored = reduced(read.ignored, {read.image.width, read.image.height}, reduction_);
            const std::string& name = names_.at(shot);
            write("images", name, image);
            if (summary_.mattes)
                write("mattes", name, grey_image(image, [&](size_t i) { return image.rgba[4 * i + 3]; }));
            if (summary_.masks)
                write("masks", name, grey_image(image, [&](size_t i) {
                          return static_cast<uint8_t>(!ignored.empty() && ignored[i] ? 0 : 255);
                      }));
            count_.add();
        }
    }
    void write(const char* folder, const std::string& name, const media::Image& image) const {
        media::write_png(output_ / folder / (name + ".png"), image);
    }

    const std::filesystem::path& output_;
    const WriteSummary& summary_;
    const Rig& rig_;
    const ImageNames& names_;
    const PlateNames& plates_;
    const std::vector<stage::Camera> cameras_;
    Count& count_;
    const uint32_t reduction_;
};

std::string file_of(Split split) {
    return split == Split::kTrain  ? "transforms_train.json"
           : split == Split::kTest ? "transforms_test.json"
                                   : "transforms_val.json";
}

// What the splits hold. An image of several splits counts once.
WriteSummary summary_of(const BothSplits& both, const ImageNames& names) {
    WriteSummary summary{.mattes = !matte_sources(both.rigs).empty(), .masks = may_ignore(both.rigs)};
    summary.missing_split = both.missing;
    std::set<std::string> images, plates;
    for (size_t r = 0; r < both.rigs.size(); ++r) {
        const Rig& rig = both.rigs[r];
        (both.splits[r] == Split::kTrain  ? summary.train_cameras
         : both.splits[r] == Split::kTest ? summary.test_cameras
                                          : summary.val_cameras) = rig.cameras.size();
        for (const Shot& shot : rig.shots) images.insert(names.at(&shot));
        for (const std::string& remark : rig.remarks)
            if (std::ranges::find(summary.remarks, remark) == summary.remarks.end()) summary.remarks.push_back(remark);
        for (const RigCamera& camera : rig.cameras)
            if (!camera.plate.path.empty()) plates.insert(camera.name);
    }
    summary.images = images.size();
    summary.plates = plates.size();
    return summary;
}

}  // namespace

WriteSummary write_dataset(const BothSplits& both, const std::filesystem::path& output, const WriteProgress& progress,
                           uint32_t reduction) {
    expect_distinct_names(both.rigs, "images/");
    const ImageNames names = image_names(both.rigs);
    WriteSummary summary = summary_of(both, names);
    for (const auto& [folder, needed] : {std::pair("images", true), std::pair("mattes", summary.mattes),
                                         std::pair("masks", summary.masks), std::pair("plates", summary.plates > 0)})
        if (needed) make_folder(output / folder);
    const PlateNames plates = plate_names(both.rigs);
    Count count(progress, summary.images);
    std::set<std::string> written;
    std::vector<std::unique_ptr<SplitWriter>> writers;
    for (const Rig& rig : both.rigs) {
        writers.push_back(std::make_unique<SplitWriter>(output, summary, rig, names, plates, count, reduction));
        writers.back()->write_images(written);
    }
    if (count.stopped()) return summary;
    for (size_t r = 0; r < writers.size(); ++r) writers[r]->write_file(output / file_of(both.splits[r]));
    summary.complete = true;
    return summary;
}

}  // namespace neuvv::training
