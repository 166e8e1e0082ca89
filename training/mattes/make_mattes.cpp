#include "training/mattes/make_mattes.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/threads/parallel.h"
#include "training/data/both_splits.h"
#include "training/data/mask_image.h"
#include "training/data/matte_sources.h"
#include "training/mattes/brought_mattes.h"
#include "training/mattes/matte_files.h"
#include "training/mattes/network_mattes.h"
#include "training/mattes/swapped_images.h"

namespace neuvv::training {

namespace {

constexpr size_t kImagesAtOnce = 16;  // images in memory while their mattes are computed on all cores

void expect_size(const Shot& shot, const media::Image& image, const media::Image& other, const char* what) {
    if (image.width != other.width || image.height != other.height)
        throw InputError(
            shot.image.path.string(), "",
            fmt::format("is {}×{}, but its {} {}×{}", image.width, image.height, what, other.width, other.height),
            "give both one size");
}

// Those of a matte of another program.
std::vector<uint8_t> values_of(const media::Image& matte, bool inverted) {
    const MaskValues found(matte);
    std::vector<uint8_t> values(matte.rgba.size() / 4);
    for (size_t i = 0; i < values.size(); ++i) values[i] = inverted ? 255 - found[i] : found[i];
    return values;
}

// Adds the mattes of a camera's images, some at a time. `read` gives what an image is compared with, or its matte;
// `matte_of` makes the matte of both on any thread. Returns false where the caller stopped it.
template <typename Read, typename MatteOf>
bool add_mattes(const CameraShots& camera, uint64_t total, MatteFiles& files, const MatteProgress& progress,
                const Read& read, const MatteOf& matte_of) {
    ImageReader reader;
    for (size_t first = 0; first < camera.shots.size(); first += kImagesAtOnce) {
        const size_t count = std::min(kImagesAtOnce, camera.shots.size() - first);
        std::vector<media::Image> images, others;
        for (size_t i = first; i < first + count; ++i) {
            images.push_back(camera.read(reader, camera.shots[i]->image));
            others.push_back(read(*camera.shots[i], images.back()));
        }
        std::vector<std::vector<uint8_t>> mattes(count);
        parallel_for(count, 1, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) mattes[i] = matte_of(images[i], others[i]);
        });
        for (size_t i = 0; i < count; ++i)
            files.add(camera.name(), camera.shots[first + i]->name, images[i], mattes[i]);
        if (progress && !progress(files.count(), total)) return false;
    }
    return true;
}

// Those of another program.
void add_brought(const MatteJob& job, const std::vector<Rig>& rigs, const std::vector<CameraShots>& cameras,
                 uint64_t total, MatteFiles& files, const MatteProgress& progress) {
    const std::vector<std::vector<ImageSource>> brought = find_brought_mattes(job.from, rigs);
    ImageReader reader;
    for (const CameraShots& camera : cameras) {
        const std::vector<ImageSource>& of_rig = brought[static_cast<size_t>(camera.rig - rigs.data())];
        const auto read = [&](const Shot& shot, const media::Image& image) {
            media::Image matte = camera.read(reader, of_rig[static_cast<size_t>(&shot - camera.rig->shots.data())]);
            expect_size(shot, image, matte, "matte");
            return matte;
        };
        const auto values = [&](const media::Image&, const media::Image& matte) {
            return values_of(matte, job.inverted);
        };
        if (!add_mattes(camera, total, files, progress, read, values)) return;
    }
}

// Those of cameras of which each is looked at by itself.
void add_differences(const MatteJob& job, const std::vector<CameraShots>& cameras,
                     const std::vector<CameraBackground>& backgrounds, uint64_t total, MatteFiles& files,
                     const MatteProgress& progress) {
    for (size_t c = 0; c < cameras.size(); ++c) {
        const media::Image& background = backgrounds[c].image;
        const auto none = [&](const Shot& shot, const media::Image& image) {
            expect_size(shot, image, background, "background");
            return media::Image();
        };
        const auto difference = [&](const media::Image& image, const media::Image&) {
            return difference_matte(image, background, kind_of_background(backgrounds[c].is_clean), job.settings);
        };
        if (!add_mattes(cameras[c], total, files, progress, none, difference)) return;
    }
}

// The background of each camera. Says in the summary which are plates. Nothing where the caller stopped it.
std::optional<std::vector<CameraBackground>> find_backgrounds(const std::vector<CameraShots>& cameras, uint64_t total,
                                                              MatteSummary& summary, const MatteProgress& progress) {
    std::vector<CameraBackground> backgrounds;
    for (const CameraShots& camera : cameras) {
        if (progress && !progress(0, total)) return {};
        backgrounds.push_back(background_of(camera));
        summary.cameras_with_plate += backgrounds.back().is_clean;
        if (!backgrounds.back().wrong_plate.empty()) summary.wrong_plates.push_back(backgrounds.back().wrong_plate);
    }
    return backgrounds;
}

// Those of a network.
void add_network(const MatteJob& job, const std::vector<Rig>& rigs, const std::vector<CameraShots>& cameras,
                 uint64_t total, MatteFiles& files, MatteSummary& summary, const MatteProgress& progress) {
    MatteNetwork network(job.model);
    std::optional<std::vector<CameraBackground>> backgrounds(std::in_place);
    if (network.wants_plate()) backgrounds = find_backgrounds(cameras, total, summary, progress);
    if (!backgrounds) return;
    Note why;  // the cameras are not compared, where they are too few
    const auto box = figure_box(rigs, cameras, why);
    summary.agreements = add_network_mattes(network, cameras, *backgrounds, box, files, progress)
                             .value_or(std::vector<CameraAgreement>());
}

// Those that this program makes. Says in the summary how.
void add_own(const MatteJob& job, const std::vector<Rig>& rigs, std::vector<CameraShots> cameras, uint64_t total,
             MatteFiles& files, MatteSummary& summary, const MatteProgress& progress) {
    std::optional<std::vector<CameraBackground>> backgrounds = find_backgrounds(cameras, total, summary, progress);
    if (!backgrounds) return;
    if (const auto box = job.alone ? std::nullopt : figure_box(rigs, cameras, summary.alone)) {
        summary.swapped = swap_images_back(cameras, *backgrounds, job.settings);
        summary.agreements = add_figure_mattes(cameras, std::move(*backgrounds), *box, job.settings, files, progress)
                                 .value_or(std::vector<CameraAgreement>());
    } else {
        add_differences(job, cameras, *backgrounds, total, files, progress);
    }
}

}  // namespace

MatteSummary make_mattes(const MatteJob& job, const MatteProgress& progress) {
    const BothSplits splits = read_both_splits(job.dataset, job.format);
    expect_distinct_names(splits.rigs, "the mattes' folder", kMatteSheetName);
    const std::vector<CameraShots> cameras = cameras_with_shots(splits.rigs);
    MatteSummary summary;
    uint64_t total = 0;
    for (const CameraShots& camera : cameras) total += camera.shots.size();
    MatteFiles files(job.output);
    if (!job.model.empty())
        add_network(job, splits.rigs, cameras, total, files, summary, progress);
    else if (!job.from.empty())
        add_brought(job, splits.rigs, cameras, total, files, progress);
    else
        add_own(job, splits.rigs, cameras, total, files, summary, progress);
    std::vector<std::string> worst;
    for (const CameraAgreement& agreement : summary.agreements) worst.push_back(agreement.camera);
    summary.sheet = files.write_sheet(worst);
    summary.images = files.count();
    summary.cameras = static_cast<uint32_t>(cameras.size());
    summary.shows_performer = files.shows_performer();
    summary.white_borders = files.white_borders();
    summary.missing_split = splits.missing;
    return summary;
}

uint64_t count_existing_mattes(const MatteJob& job) {
    uint64_t existing = 0;
    std::error_code ignored;
    for (const Rig& rig : read_both_splits(job.dataset, job.format).rigs)
        for (const Shot& shot : rig.shots)
            existing += std::filesystem::exists(matte_file(job.output, rig, shot), ignored);
    return existing;
}

}  // namespace neuvv::training
