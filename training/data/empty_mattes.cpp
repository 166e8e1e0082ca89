#include "training/data/empty_mattes.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "base/threads/parallel.h"
#include "training/data/layouts/rig/image_reader.h"
#include "training/data/mask_image.h"
#include "training/data/matte_sources.h"
#include "training/data/segments.h"

namespace neuvv::training {

namespace {

constexpr uint8_t kFaint = 32;  // what mattes have less of counts as background

// The file that tells what of the image is the performer, with what white means there.
std::pair<ImageSource, MaskMeaning> matte_of(const Rig& rig, const Shot& shot) {
    std::error_code ignored;
    const std::filesystem::path file = matte_file(mattes_folder(rig), rig, shot);
    if (std::filesystem::is_regular_file(file, ignored)) return {{file, -1}, MaskMeaning::kMatte};
    const bool is_matte = rig.masks == MaskMeaning::kMatte || rig.masks == MaskMeaning::kLabels;
    if (is_matte && !shot.mask.path.empty()) return {shot.mask, rig.masks};
    return {shot.image, MaskMeaning::kMatte};
}

bool shows_something(const media::Image& matte, MaskMeaning meaning) {
    const int least = meaning == MaskMeaning::kLabels ? 1 : kFaint;
    const MaskValues values(matte);
    for (size_t i = 0; i < matte.rgba.size() / 4; ++i)
        if (values[i] >= least) return true;
    return false;
}

// Marks which of a camera's images show something. Where the first one without a matte of its own is opaque, the others
// are taken to be so, too, and are not read.
template <typename Done>
void read_camera(const Rig& rig, const std::vector<uint32_t>& shots, std::vector<uint8_t>& shows, const Done& done) {
    ImageReader mattes, images;
    std::optional<bool> has_alpha;
    for (const uint32_t shot : shots) {
        const auto [source, meaning] = matte_of(rig, rig.shots[shot]);
        if (source.path != rig.shots[shot].image.path) {
            shows[shot] = shows_something(mattes.read(source), meaning);
        } else if (has_alpha.value_or(true)) {
            const media::Image image = images.read(source);
            const bool opaque = is_opaque(image);
            if (!has_alpha) has_alpha = !opaque;
            shows[shot] = opaque || shows_something(image, meaning);
        }
        done();
    }
}

// At most so many that their images are at most `most_images`, evenly spread.
std::map<double, std::vector<uint32_t>> shots_by_time(const Rig& rig, size_t most_images) {
    const std::vector<double> times = times_of(rig);
    const size_t most_times = std::max<size_t>(1, most_images * times.size() / std::max<size_t>(1, rig.shots.size()));
    const size_t count = std::min(times.size(), most_times);
    std::map<double, std::vector<uint32_t>> chosen;
    for (size_t i = 0; i < count; ++i) chosen[times[i * times.size() / count]];
    for (uint32_t i = 0; i < rig.shots.size(); ++i)
        if (const auto of_time = chosen.find(rig.shots[i].time); of_time != chosen.end()) of_time->second.push_back(i);
    return chosen;
}

}  // namespace

EmptyMattes find_empty_mattes(const Rig& rig, size_t most_images,
                              const std::function<void(uint64_t done, uint64_t total)>& progress) {
    const std::map<double, std::vector<uint32_t>> by_time = shots_by_time(rig, most_images);
    std::vector<std::vector<uint32_t>> by_camera(rig.cameras.size());
    uint64_t total = 0, done = 0;
    for (const auto& [time, shots] : by_time) {
        total += shots.size();
        for (const uint32_t shot : shots) by_camera[rig.shots[shot].camera].push_back(shot);
    }
    std::vector<uint8_t> shows(rig.shots.size(), 1);
    std::mutex mutex;
    parallel_for(by_camera.size(), 1, [&](size_t begin, size_t end) {
        for (size_t camera = begin; camera < end; ++camera)
            read_camera(rig, by_camera[camera], shows, [&] {
                const std::scoped_lock lock(mutex);
                if (progress) progress(++done, total);
            });
    });
    EmptyMattes found{.times = times_of(rig).size(), .looked_at = by_time.size()};
    for (const auto& [time, shots] : by_time) {
        const auto empty = std::ranges::count_if(shots, [&](uint32_t shot) { return shows[shot] == 0; });
        if (2 * static_cast<size_t>(empty) >= shots.size()) continue;
        for (const uint32_t shot : shots)
            if (shows[shot] == 0) found.shots.push_back(shot);
    }
    std::ranges::sort(found.shots);
    return found;
}

}  // namespace neuvv::training
