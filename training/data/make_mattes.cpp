#include "training/data/make_mattes.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "training/data/both_splits.h"
#include "training/data/brought_mattes.h"
#include "training/data/contact_sheet.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/plate.h"

namespace neuvv::training {

namespace {

constexpr size_t kImagesAtOnce = 16;  // images in memory while their mattes are computed on all cores
constexpr size_t kSheetRows = 12;
constexpr uint32_t kSheetCell = 320;
constexpr uint8_t kMagenta[3] = {255, 0, 255};
constexpr const char* kSheetName = "contact_sheet";

BothSplits read_rigs(const MatteJob& job) {
    return read_both_splits(job.dataset, job.format);
}

// The values of a matte of another program: its alpha where it has one, else the brightest of R, G and B.
std::vector<uint8_t> values_of(const media::Image& matte, bool inverted) {
    bool has_alpha = false;
    for (size_t i = 3; i < matte.rgba.size() && !has_alpha; i += 4) has_alpha = matte.rgba[i] != 255;
    std::vector<uint8_t> values(matte.rgba.size() / 4);
    for (size_t i = 0; i < values.size(); ++i) {
        const uint8_t* at = &matte.rgba[4 * i];
        values[i] = has_alpha ? at[3] : std::max({at[0], at[1], at[2]});
        if (inverted) values[i] = 255 - values[i];
    }
    return values;
}

// Which share of the pixels along the image's borders is white.
double white_borders_of(const std::vector<uint8_t>& matte, uint32_t width, uint32_t height) {
    uint64_t white = 0, all = 0;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; x += y == 0 || y + 1 == height || width < 2 ? 1 : width - 1) {
            white += matte[size_t{y} * width + x] >= 128;
            ++all;
        }
    return all > 0 ? static_cast<double>(white) / static_cast<double>(all) : 0;
}

media::Image composite(const media::Image& image, const std::vector<uint8_t>& alpha) {
    media::Image cut = image;
    for (size_t i = 0; i < alpha.size(); ++i) cut.rgba[4 * i + 3] = alpha[i];
    return media::composite_over(cut, kMagenta);
}

// The values as a grey image of the size of `like`.
media::Image grey_image(const media::Image& like, const std::vector<uint8_t>& values) {
    media::Image image(like.width, like.height);
    for (size_t i = 0; i < values.size(); ++i) {
        std::fill_n(&image.rgba[4 * i], 3, values[i]);
        image.rgba[4 * i + 3] = 255;
    }
    return image;
}

// Where the calibration says how large images are, others are not decoded. The rig and the source must outlive it.
ImageReader::ExpectSize size_of_camera(const Rig& rig, uint32_t camera, const ImageSource& source) {
    const interchange::Lens& lens = rig.cameras[camera].lens;
    if (lens.width == 0) return {};
    return [&, camera](media::ImageSize size) {
        if (size.width != lens.width || size.height != lens.height)
            throw InputError(source.path.string(), "",
                             fmt::format("is {}×{}, but its camera {} in {} says {}×{}", size.width, size.height,
                                         rig.cameras[camera].name, rig.file, lens.width, lens.height),
                             "give all images and mattes of a camera the size that its calibration is for");
    };
}

// Makes the mattes of one camera after the other.
class MatteMaker {
  public:
    MatteMaker(const MatteJob& job, const MatteProgress& progress, uint64_t total, size_t cameras)
        : job_(job), progress_(progress), total_(total), sheet_every_(std::max<size_t>(1, cameras / kSheetRows)) {}

    // `brought` are the mattes of all shots of the rig, where the job takes those of another program. Returns false
    // where the caller stopped it.
    bool make(const Rig& rig, uint32_t camera, const std::vector<const Shot*>& shots,
              const std::vector<ImageSource>& brought) {
        const bool on_sheet = cameras_++ % sheet_every_ == 0 && sheet_.size() < 3 * kSheetRows;
        const media::Image background = job_.from.empty() ? background_of(rig, camera, shots) : media::Image();
        for (size_t begin = 0; begin < shots.size(); begin += kImagesAtOnce) {
            const std::vector<const Shot*> group(
                shots.begin() + static_cast<ptrdiff_t>(begin),
                shots.begin() + static_cast<ptrdiff_t>(std::min(begin + kImagesAtOnce, shots.size())));
            make_group(rig, group, brought, background, on_sheet && begin == 0);
            done_ += group.size();
            if (progress_ && !progress_(done_, total_)) return false;
        }
        return true;
    }
    void write_sheet() const {
        media::write_png(job_.output / "contact_sheet.png", contact_sheet(sheet_, 3, kSheetCell));
    }
    uint64_t done() const { return done_; }
    uint32_t plates() const { return plates_; }
    bool shows_performer() const { return shows_performer_; }
    double white_borders() const { return done_ > 0 ? white_borders_ / static_cast<double>(done_) : 0; }

  private:
    media::Image background_of(const Rig& rig, uint32_t camera, const std::vector<const Shot*>& shots);
    void make_group(const Rig& rig, const std::vector<const Shot*>& shots, const std::vector<ImageSource>& brought,
                    const media::Image& background, bool on_sheet);
    static media::Image read(ImageReader& reader, const Rig& rig, uint32_t camera, const ImageSource& source);

    const MatteJob& job_;
    const MatteProgress& progress_;
    uint64_t total_, done_ = 0;
    size_t sheet_every_, cameras_ = 0;
    uint32_t plates_ = 0;
    bool shows_performer_ = false;
    double white_borders_ = 0;  // the sum over all mattes of another program
    ImageReader images_, external_;
    std::vector<media::Image> sheet_;
};

media::Image MatteMaker::background_of(const Rig& rig, uint32_t camera, const std::vector<const Shot*>& shots) {
    if (!rig.cameras[camera].plate.path.empty()) {
        ++plates_;
        return read_plate(rig.cameras[camera].plate, size_of_camera(rig, camera, rig.cameras[camera].plate));
    }
    if (shots.size() < kMinMedianFrames)
        throw InputError(rig.file, "camera " + rig.cameras[camera].name,
                         fmt::format("has no clean plate and {} images: their median says nothing about the background",
                                     shots.size()),
                         fmt::format("give it a clean plate, or at least {} images", kMinMedianFrames));
    const size_t count = std::min<size_t>(shots.size(), kMaxMedianFrames);
    std::vector<media::Image> frames;
    for (size_t i = 0; i < count; ++i) {
        frames.push_back(read(images_, rig, camera, shots[i * (shots.size() - 1) / (count - 1)]->image));
        if (frames[i].rgba.size() != frames[0].rgba.size() || frames[i].width != frames[0].width)
            throw InputError(rig.file, shots[0]->place, "the images of its camera have several sizes",
                             "give all images of a camera one size");
    }
    return median_background(frames);
}

media::Image MatteMaker::read(ImageReader& reader, const Rig& rig, uint32_t camera, const ImageSource& source) {
    return reader.read(source, size_of_camera(rig, camera, source));
}

void MatteMaker::make_group(const Rig& rig, const std::vector<const Shot*>& shots,
                            const std::vector<ImageSource>& brought, const media::Image& background, bool on_sheet) {
    std::vector<media::Image> images, external;
    for (const Shot* shot : shots) {
        images.push_back(read(images_, rig, shot->camera, shot->image));
        if (!job_.from.empty())
            external.push_back(
                read(external_, rig, shot->camera, brought[static_cast<size_t>(shot - rig.shots.data())]));
        const media::Image& with = job_.from.empty() ? background : external.back();
        if (with.width != images.back().width || with.height != images.back().height)
            throw InputError(shot->image.path.string(), "",
                             fmt::format("is {}×{}, but its {} {}×{}", images.back().width, images.back().height,
                                         job_.from.empty() ? "background" : "matte", with.width, with.height),
                             "give both one size");
    }
    std::vector<std::vector<uint8_t>> mattes(shots.size());
    parallel_for(shots.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            mattes[i] = job_.from.empty() ? difference_matte(images[i], background, job_.settings)
                                          : values_of(external[i], job_.inverted);
            media::write_png(job_.output / (shots[i]->name + ".png"), grey_image(images[i], mattes[i]));
        }
    });
    for (const std::vector<uint8_t>& matte : mattes)
        shows_performer_ = shows_performer_ || std::ranges::any_of(matte, [](uint8_t value) { return value >= 128; });
    for (size_t i = 0; i < external.size(); ++i)
        white_borders_ += white_borders_of(mattes[i], external[i].width, external[i].height);
    if (!on_sheet) return;
    media::Image opaque = images[0];
    for (size_t i = 3; i < opaque.rgba.size(); i += 4) opaque.rgba[i] = 255;
    sheet_.push_back(opaque);
    sheet_.push_back(grey_image(opaque, mattes[0]));
    sheet_.push_back(composite(opaque, mattes[0]));
}

std::vector<std::vector<const Shot*>> shots_by_camera(const Rig& rig) {
    std::vector<std::vector<const Shot*>> shots(rig.cameras.size());
    for (const Shot& shot : rig.shots) shots[shot.camera].push_back(&shot);
    return shots;
}

}  // namespace

MatteSummary make_mattes(const MatteJob& job, const MatteProgress& progress) {
    const BothSplits both = read_rigs(job);
    expect_distinct_names(both.rigs, "the mattes' folder", kSheetName);
    MatteSummary summary;
    uint64_t total = 0;
    for (const Rig& rig : both.rigs) {
        total += rig.shots.size();
        summary.cameras += static_cast<uint32_t>(rig.cameras.size());
    }
    const std::vector<std::vector<ImageSource>> brought = job.from.empty()
                                                              ? std::vector<std::vector<ImageSource>>(both.rigs.size())
                                                              : find_brought_mattes(job.from, both.rigs);
    MatteMaker maker(job, progress, total, summary.cameras);
    bool go_on = true;
    for (size_t r = 0; r < both.rigs.size(); ++r) {
        const Rig& rig = both.rigs[r];
        const auto shots = shots_by_camera(rig);
        for (uint32_t camera = 0; camera < rig.cameras.size() && go_on; ++camera)
            if (!shots[camera].empty()) go_on = maker.make(rig, camera, shots[camera], brought[r]);
    }
    maker.write_sheet();
    summary.images = maker.done();
    summary.cameras_with_plate = maker.plates();
    summary.shows_performer = maker.shows_performer();
    summary.white_borders = maker.white_borders();
    summary.missing_split = both.missing;
    return summary;
}

std::vector<std::string> matte_sources(const std::vector<Rig>& splits) {
    constexpr size_t kMostImages = 8;  // of a split, whose alpha is looked at
    bool mattes = false, masks = false, alpha = false;
    std::filesystem::path masks_folder;
    std::error_code ignored;
    for (const Rig& rig : splits) {
        const bool means_matte = rig.masks == MaskMeaning::kMatte || rig.masks == MaskMeaning::kLabels;
        std::vector<const Shot*> first(rig.cameras.size());
        for (const Shot& shot : rig.shots) {
            mattes |= std::filesystem::is_regular_file(rig.folder / "mattes" / (shot.name + ".png"), ignored);
            if (means_matte && !shot.mask.path.empty()) {
                masks = true;
                masks_folder = shot.mask.path.lexically_relative(rig.folder);
            }
            if (!first[shot.camera]) first[shot.camera] = &shot;
        }
        for (size_t i = 0; i < std::min(first.size(), kMostImages) && !alpha; ++i) {
            const Shot* shot = first[i * first.size() / std::min(first.size(), kMostImages)];
            if (!shot) continue;
            const media::Image image = ImageReader().read(shot->image);
            for (size_t at = 3; at < image.rgba.size() && !alpha; at += 4) alpha = image.rgba[at] != 255;
        }
    }
    std::vector<std::string> sources;
    if (mattes) sources.emplace_back("mattes/");
    if (masks) sources.push_back(masks_folder.begin()->string() + "/");
    if (alpha) sources.emplace_back("the alpha of the images");
    return sources;
}

std::vector<std::string> matte_sources(const MatteJob& job) {
    return matte_sources(read_rigs(job).rigs);
}

uint64_t count_existing_mattes(const MatteJob& job) {
    uint64_t existing = 0;
    std::error_code ignored;
    for (const Rig& rig : read_rigs(job).rigs)
        for (const Shot& shot : rig.shots)
            existing += std::filesystem::exists(job.output / (shot.name + ".png"), ignored);
    return existing;
}

}  // namespace neuvv::training
