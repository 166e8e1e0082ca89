#include "training/mattes/network_mattes.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <mutex>

#include "base/threads/parallel.h"
#include "training/data/mask_image.h"
#include "training/mattes/working_size.h"

namespace neuvv::training {

namespace {

constexpr size_t kNetworkImagesAtOnce = 16;  // of full size in memory
constexpr double kPause = 1.5;               // times the usual time between two images of a camera
constexpr uint8_t kHalfOpaque = 128;

// One camera as the network sees it.
struct SeenCamera {
    std::mutex mutex;  // for one thread at a time, as the reader goes on in a video where it is
    ImageReader reader;
    MatteNetwork::Memory memory;
    double last = -std::numeric_limits<double>::infinity();  // the time of its last image
    double longest_step = 0;                                 // after a longer one, its images pause
    std::optional<WorkingCamera> working;                    // once its images' size is known
};

// The median time between two images of a camera.
double usual_step(const CameraShots& camera) {
    std::vector<double> times, steps;
    for (const Shot* shot : camera.shots) times.push_back(shot->time);
    std::ranges::sort(times);
    for (size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
    if (steps.empty()) return 0;
    const auto middle = steps.begin() + static_cast<ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    return *middle;
}

class NetworkMattes {
  public:
    NetworkMattes(MatteNetwork& network, const std::vector<CameraShots>& cameras,
                  const std::vector<CameraBackground>& backgrounds,
                  const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box, MatteFiles& files,
                  const MatteProgress& progress);
    bool run();
    std::vector<CameraAgreement> agreements() const {
        return box_ ? agreement_.of(cameras_) : std::vector<CameraAgreement>();
    }

  private:
    // Which shot of which camera.
    struct SeenShot {
        uint32_t camera;
        const Shot* shot;
    };

    media::Image read(const SeenShot& at);
    std::vector<uint8_t> matte_of(const SeenShot& at, const media::Image& image);
    Look look_of(const SeenShot& at, const media::Image& image, const std::vector<uint8_t>& matte) const;
    bool add(const std::vector<SeenShot>& shots);
    void compare(Moment& moment);

    MatteNetwork& network_;
    const std::vector<CameraShots>& cameras_;
    const std::vector<CameraBackground>& backgrounds_;
    const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box_;
    MatteFiles& files_;
    const MatteProgress& progress_;
    std::deque<SeenCamera> seen_;               // by camera
    std::vector<FigureCamera> figure_cameras_;  // by camera; filled in with the first image of each
    std::map<double, std::vector<SeenShot>> times_;
    AgreementSums agreement_;
    uint64_t total_ = 0;
};

NetworkMattes::NetworkMattes(MatteNetwork& network, const std::vector<CameraShots>& cameras,
                             const std::vector<CameraBackground>& backgrounds,
                             const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box, MatteFiles& files,
                             const MatteProgress& progress)
    : network_(network),
      cameras_(cameras),
      backgrounds_(backgrounds),
      box_(box),
      files_(files),
      progress_(progress),
      seen_(cameras.size()),
      figure_cameras_(cameras.size()),
      agreement_(cameras.size()) {
    for (uint32_t c = 0; c < cameras.size(); ++c) {
        seen_[c].longest_step = kPause * usual_step(cameras[c]);
        for (const Shot* shot : cameras[c].shots) times_[shot->time].push_back({c, shot});
        total_ += cameras[c].shots.size();
    }
}

media::Image NetworkMattes::read(const SeenShot& at) {
    SeenCamera& camera = seen_[at.camera];
    const std::scoped_lock lock(camera.mutex);
    media::Image image = cameras_[at.camera].read(camera.reader, at.shot->image);
    media::ImageSize size{image.width, image.height};
    if (camera.working) size = {camera.working->lens.width, camera.working->lens.height};
    if (network_.wants_plate()) size = {backgrounds_[at.camera].image.width, backgrounds_[at.camera].image.height};
    if (image.width != size.width || image.height != size.height)
        throw InputError(
            at.shot->image.path.string(), "",
            fmt::format("is {}×{}, but {} of its camera {}×{}", image.width, image.height,
                        network_.wants_plate() ? "the background" : "another image", size.width, size.height),
            "give all images of a camera one size");
    if (!camera.working) {
        camera.working = working_camera(cameras_[at.camera].calibration(), size);
        figure_cameras_[at.camera] = {
            .camera = camera.working->camera, .unseen = unseen_pixels(*camera.working), .background = {}};
    }
    return image;
}

std::vector<uint8_t> NetworkMattes::matte_of(const SeenShot& at, const media::Image& image) {
    SeenCamera& camera = seen_[at.camera];
    if (at.shot->time - camera.last > camera.longest_step) camera.memory.clear();
    camera.last = at.shot->time;
    const media::Image none;
    const media::Image& plate = network_.wants_plate() ? backgrounds_[at.camera].image : none;
    return network_.matte_of(image, plate, camera.memory, at.shot->name);
}

Look NetworkMattes::look_of(const SeenShot& at, const media::Image& image, const std::vector<uint8_t>& matte) const {
    const media::Image small =
        working_image(*seen_[at.camera].working, grey_image(image, [&](size_t i) { return matte[i]; }));
    Look look{.camera = at.camera, .image = {}, .figure = PixelMask(small.width, small.height)};
    for (size_t i = 0; i < look.figure.size(); ++i)
        look.figure.set[i] = small.rgba[4 * i] >= kHalfOpaque && !figure_cameras_[at.camera].unseen[i];
    return look;
}

// Adds up how the mattes of one time agree.
void NetworkMattes::compare(Moment& moment) {
    if (!box_ || moment.size() < kMinFigureCameras) return;
    const std::vector<PixelMask> hulls = hull_of_figures(figure_cameras_, *box_, moment);
    for (size_t i = 0; i < moment.size(); ++i) agreement_.add(moment[i].camera, moment[i].figure, hulls[i]);
}

// The mattes of one time. Images are read on all cores; the network takes all of them for one image.
bool NetworkMattes::add(const std::vector<SeenShot>& shots) {
    Moment moment;
    for (size_t first = 0; first < shots.size(); first += kNetworkImagesAtOnce) {
        const size_t count = std::min(kNetworkImagesAtOnce, shots.size() - first);
        std::vector<media::Image> images(count);
        parallel_for(count, 1, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) images[i] = read(shots[first + i]);
        });
        for (size_t i = 0; i < count; ++i) {
            const SeenShot& at = shots[first + i];
            const std::vector<uint8_t> matte = matte_of(at, images[i]);
            if (box_) moment.push_back(look_of(at, images[i], matte));
            files_.add(cameras_[at.camera].name(), at.shot->name, images[i], matte);
            if (progress_ && !progress_(files_.count(), total_)) return false;
        }
    }
    compare(moment);
    return true;
}

bool NetworkMattes::run() {
    if (progress_ && !progress_(0, total_)) return false;
    return std::ranges::all_of(times_, [&](const auto& time) { return add(time.second); });
}

}  // namespace

std::optional<std::vector<CameraAgreement>> add_network_mattes(
    MatteNetwork& network, const std::vector<CameraShots>& cameras, const std::vector<CameraBackground>& backgrounds,
    const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box, MatteFiles& files, const MatteProgress& progress) {
    NetworkMattes mattes(network, cameras, backgrounds, box, files, progress);
    if (!mattes.run()) return {};
    return mattes.agreements();
}

}  // namespace neuvv::training
