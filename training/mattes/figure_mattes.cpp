#include "training/mattes/figure_mattes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>

#include "base/threads/parallel.h"
#include "training/mattes/soft_edges.h"
#include "training/mattes/working_size.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

constexpr size_t kLooksAtOnce = 800;   // in memory: 1.5 GB
constexpr double kSearchShare = 0.85;  // of the work for these looks; the rest is reading and writing
constexpr size_t kMattesAtOnce = 16;   // of full size in memory

class FigureMattes {
  public:
    FigureMattes(const std::vector<CameraShots>& cameras, std::vector<CameraBackground> backgrounds,
                 const MatteSettings& settings, MatteFiles& files, const MatteProgress& progress);
    bool run(const std::pair<glm::dvec3, glm::dvec3>& box);
    std::vector<CameraAgreement> agreements() const { return agreement_.of(cameras_); }

  private:
    // Which shot of which camera.
    struct ShotOf {
        uint32_t camera;
        const Shot* shot;
    };

    std::vector<Moment> read_moments(const std::vector<const std::vector<ShotOf>*>& times);
    media::Image read(const ShotOf& at);
    std::vector<uint8_t> matte_of(const media::Image& image, const Look& look) const;
    void write(const std::vector<ShotOf>& shots, const Moment& moment);
    bool told(double share_of_part) const;

    const std::vector<CameraShots>& cameras_;
    const MatteSettings& settings_;
    MatteFiles& files_;
    const MatteProgress& progress_;
    std::vector<WorkingCamera> working_;
    std::vector<FigureCamera> figure_cameras_;
    std::vector<media::Image> plates_;  // by camera, of the images' size; empty where there is no clean plate
    std::map<double, std::vector<ShotOf>> times_;
    AgreementSums agreement_;
    // By camera. A reader goes on in a video where it is, so each camera keeps its own, for one thread at a time.
    struct Reader {
        std::mutex mutex;
        ImageReader images;
    };
    std::deque<Reader> readers_;
    uint64_t total_ = 0, part_ = 0;  // images in all, and those that are worked on
};

FigureMattes::FigureMattes(const std::vector<CameraShots>& cameras, std::vector<CameraBackground> backgrounds,
                           const MatteSettings& settings, MatteFiles& files, const MatteProgress& progress)
    : cameras_(cameras),
      settings_(settings),
      files_(files),
      progress_(progress),
      agreement_(cameras.size()),
      readers_(cameras.size()) {
    for (uint32_t c = 0; c < cameras.size(); ++c) {
        media::Image& background = backgrounds[c].image;
        working_.push_back(working_camera(cameras[c].calibration(), {background.width, background.height}));
        const WorkingCamera& working = working_.back();
        figure_cameras_.push_back({.camera = working.camera,
                                   .unseen = unseen_pixels(working),
                                   .background = working_image(working, background),
                                   .is_clean = backgrounds[c].is_clean});
        plates_.push_back(backgrounds[c].is_clean ? std::move(background) : media::Image());
        for (const Shot* shot : cameras[c].shots) times_[shot->time].push_back({c, shot});
        total_ += cameras[c].shots.size();
    }
}

media::Image FigureMattes::read(const ShotOf& at) {
    const CameraShots& camera = cameras_[at.camera];
    Reader& reader = readers_[at.camera];
    const std::scoped_lock lock(reader.mutex);
    media::Image image = camera.read(reader.images, at.shot->image);
    const interchange::Lens& lens = working_[at.camera].lens;
    if (image.width != lens.width || image.height != lens.height)
        throw InputError(
            at.shot->image.path.string(), "",
            fmt::format("is {}×{}, but its background {}×{}", image.width, image.height, lens.width, lens.height),
            "give both one size");
    return image;
}

// Camera by camera, as the frames of a video are read one after the other.
std::vector<Moment> FigureMattes::read_moments(const std::vector<const std::vector<ShotOf>*>& times) {
    std::vector<Moment> moments;
    std::vector<std::vector<std::pair<Look*, const Shot*>>> looks(cameras_.size());
    for (const std::vector<ShotOf>* time : times) moments.emplace_back(time->size());
    for (size_t t = 0; t < times.size(); ++t)
        for (size_t i = 0; i < moments[t].size(); ++i) {
            const ShotOf& at = (*times[t])[i];
            moments[t][i].camera = at.camera;
            looks[at.camera].emplace_back(&moments[t][i], at.shot);
        }
    parallel_for(cameras_.size(), 1, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) {
            for (const auto& [look, shot] : looks[c])
                look->image = working_image(working_[c], read({static_cast<uint32_t>(c), shot}));
        }
    });
    return moments;
}

// At the size of the image that the camera took, whose own pixels say where edges are.
std::vector<uint8_t> FigureMattes::matte_of(const media::Image& image, const Look& look) const {
    const WorkingCamera& working = working_[look.camera];
    const media::Image& plate = plates_[look.camera];
    if (plate.rgba.empty()) return soft_edges(image, full_size(working, look.figure), working.factor);
    PixelMask figure = differing_pixels(image, plate, BackgroundKind::kPlate, settings_);
    const PixelMask possible = full_size(working, look.possible), sure = full_size(working, look.sure);
    for (size_t i = 0; i < figure.size(); ++i) figure.set[i] = (figure[i] && possible[i]) || sure[i];
    return soft_edges(image, figure, plate);
}

void FigureMattes::write(const std::vector<ShotOf>& shots, const Moment& moment) {
    for (size_t first = 0; first < shots.size(); first += kMattesAtOnce) {
        const size_t count = std::min(kMattesAtOnce, shots.size() - first);
        std::vector<media::Image> images(count);
        std::vector<std::vector<uint8_t>> mattes(count);
        parallel_for(count, 1, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                images[i] = read(shots[first + i]);
                mattes[i] = matte_of(images[i], moment[first + i]);
            }
        });
        for (size_t i = 0; i < count; ++i) {
            const ShotOf& at = shots[first + i];
            files_.add(cameras_[at.camera].name(), at.shot->name, images[i], mattes[i]);
            agreement_.add(at.camera, moment[first + i].figure, moment[first + i].hull);
        }
    }
}

bool FigureMattes::told(double share_of_part) const {
    return !progress_ ||
           progress_(files_.count() + static_cast<uint64_t>(share_of_part * static_cast<double>(part_)), total_);
}

bool FigureMattes::run(const std::pair<glm::dvec3, glm::dvec3>& box) {
    // Each part has moments from all over the clip, so that the performer moves as much as can be.
    const size_t parts = (total_ + kLooksAtOnce - 1) / kLooksAtOnce;
    for (size_t part = 0; part < parts; ++part) {
        std::vector<const std::vector<ShotOf>*> times;
        part_ = 0;
        size_t place = 0;
        for (const auto& [time, shots] : times_) {
            if (place++ % parts != part) continue;
            times.push_back(&shots);
            part_ += shots.size();
        }
        std::vector<Moment> moments = read_moments(times);
        const auto searched = [&](double share) { return told(kSearchShare * share); };
        if (!find_figures(figure_cameras_, box, settings_, moments, searched)) return false;
        for (size_t t = 0; t < times.size(); ++t) {
            write(*times[t], moments[t]);
            part_ -= times[t]->size();
            if (!told(kSearchShare)) return false;
        }
    }
    return true;
}

}  // namespace

std::optional<std::pair<glm::dvec3, glm::dvec3>> figure_box(const std::vector<Rig>& rigs,
                                                            const std::vector<CameraShots>& cameras, Note& why) {
    if (cameras.size() < kMinFigureCameras) {
        why = Note(fmt::format("{} cameras are too few to say where the performer is", cameras.size()));
        return {};
    }
    std::map<double, size_t> images;
    for (const CameraShots& camera : cameras)
        for (const Shot* shot : camera.shots) ++images[shot->time];
    const auto few = std::ranges::count_if(images, [](const auto& time) { return time.second < kMinFigureCameras; });
    if (2 * static_cast<size_t>(few) > images.size()) {
        why = Note(fmt::format("{} of {} times have fewer than {} images", few, images.size(), kMinFigureCameras));
        return {};
    }
    Dataset dataset;
    dataset.folder = rigs.front().folder;
    dataset.box = rigs.front().box;
    for (const CameraShots& camera : cameras) {
        const interchange::Lens& lens = camera.calibration().lens;
        const auto size = [](uint32_t pixels, double middle) {
            return pixels > 0 ? pixels : static_cast<uint32_t>(std::max(1.0, 2 * middle));
        };
        dataset.cameras.push_back({.world_from_camera = camera.calibration().world_from_camera,
                                   .fx = lens.fx,
                                   .fy = lens.fy,
                                   .cx = lens.cx,
                                   .cy = lens.cy,
                                   .width = size(lens.width, lens.cx),
                                   .height = size(lens.height, lens.cy)});
    }
    try {
        return first_box(dataset);
    } catch (const InputError& error) {
        why = Note(error);
        return {};
    }
}

std::optional<std::vector<CameraAgreement>> add_figure_mattes(const std::vector<CameraShots>& cameras,
                                                              std::vector<CameraBackground> backgrounds,
                                                              const std::pair<glm::dvec3, glm::dvec3>& box,
                                                              const MatteSettings& settings, MatteFiles& files,
                                                              const MatteProgress& progress) {
    FigureMattes mattes(cameras, std::move(backgrounds), settings, files, progress);
    if (!mattes.run(box)) return {};
    return mattes.agreements();
}

}  // namespace neuvv::training
