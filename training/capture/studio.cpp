#include "training/capture/studio.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "base/output_path.h"
#include "training/capture/capture_files.h"

namespace neuvv::training {

namespace {

constexpr double kFullWell_electrons = 6000;  // at a linear value of 1 before the gains
constexpr double kReadNoise_electrons = 6;    // standard deviation
constexpr double kLeastGain = 0.7, kMostGain = 1.4;
constexpr double kMinLoss = 0.05, kMaxLoss = 0.2;  // of light in the corners: by r², and again by r⁴
constexpr double kWrongShare = 0.01;               // of mattes
constexpr uint8_t kGreenCloth[3] = {20, 170, 60};
constexpr int kDirections[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

// Functions of the C++ library that differ between machines are not used: distributions, shuffles, logarithms.
class StudioDice {
  public:
    explicit StudioDice(uint64_t seed) : random_(seed) {}
    size_t below(size_t count) { return static_cast<size_t>(random_() % count); }
    // Of thousandths, so that what is written is what was used.
    double between(double low, double high) {
        const double share = static_cast<double>(random_() >> 11) * 0x1p-53;
        return std::round((low + share * (high - low)) * 1000) / 1000;
    }

  private:
    std::mt19937_64 random_;
};

uint64_t mixed(uint64_t value) {  // the finaliser of SplitMix64
    value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9u;
    value = (value ^ value >> 27) * 0x94d049bb133111ebu;
    return value ^ value >> 31;
}

// Nearly a normal distribution of deviation 1: the sum of four even ones, whose variance is 1/3.
double noise_of(uint64_t key) {
    const uint64_t bits = mixed(key);
    double sum = 0;
    for (int part = 0; part < 4; ++part) sum += static_cast<double>(bits >> 16 * part & 0xffff) / 65535;
    return (sum - 2) * std::sqrt(3.0);
}

double squared_radius(const media::Image& image, uint32_t x, uint32_t y) {
    const double width = image.width, height = image.height, dx = 2 * x + 1 - width, dy = 2 * y + 1 - height;
    return (dx * dx + dy * dy) / (width * width + height * height);
}

// Swaps two cameras, and spoils the plates of two others.
void confuse_cameras(Studio& studio, std::vector<size_t> train, StudioDice& dice) {
    const auto take = [&] {
        const auto at = train.begin() + static_cast<std::ptrdiff_t>(dice.below(train.size()));
        const size_t camera = *at;
        train.erase(at);
        return camera;
    };
    const size_t a = take(), b = take(), other = take(), lacking = take();
    std::swap(studio.cameras[a].filed_as, studio.cameras[b].filed_as);
    studio.cameras[other].plate_fault = PlateFault::kOfAnotherCamera;
    studio.cameras[other].plate_of = train[dice.below(train.size())];
    studio.cameras[lacking].plate_fault = dice.below(2) == 0 ? PlateFault::kGreen : PlateFault::kMissing;
}

void choose_wrong_mattes(Studio& studio, const std::vector<size_t>& train, uint32_t frames, StudioDice& dice) {
    const size_t images = train.size() * frames;
    const auto count = std::max<size_t>(1, static_cast<size_t>(std::lround(kWrongShare * static_cast<double>(images))));
    while (studio.wrong_mattes.size() < count) {
        const size_t image = dice.below(images);
        const WrongMatte wrong{train[image / frames], static_cast<uint32_t>(image % frames),
                               static_cast<MatteFault>(dice.below(3)), static_cast<uint32_t>(dice.below(8))};
        if (!studio.wrong_matte(wrong.camera, wrong.frame)) studio.wrong_mattes.push_back(wrong);
    }
    std::ranges::sort(studio.wrong_mattes, {}, [](const WrongMatte& w) { return std::pair(w.camera, w.frame); });
}

// Removes the outermost part of the foreground in a direction.
void cut_off(media::Image& matte, uint32_t direction, double share) {
    const auto along = [&](uint32_t x, uint32_t y) {
        return kDirections[direction][0] * static_cast<int>(x) + kDirections[direction][1] * static_cast<int>(y);
    };
    std::vector<int> places;
    for (uint32_t y = 0; y < matte.height; ++y)
        for (uint32_t x = 0; x < matte.width; ++x)
            if (matte.at(x, y)[0] > 0) places.push_back(along(x, y));
    if (places.empty()) return;
    const auto first = places.begin() + static_cast<std::ptrdiff_t>((1 - share) * static_cast<double>(places.size()));
    std::nth_element(places.begin(), first, places.end());
    for (uint32_t y = 0; y < matte.height; ++y)
        for (uint32_t x = 0; x < matte.width; ++x)
            if (along(x, y) >= *first) std::fill_n(matte.at(x, y), 3, uint8_t{0});
}

// Shows the performer a second time beside the first, like somebody who walks through the image.
void add_second_body(media::Image& matte, uint32_t direction) {
    uint32_t left = matte.width, right = 0;
    for (uint32_t y = 0; y < matte.height; ++y)
        for (uint32_t x = 0; x < matte.width; ++x)
            if (matte.at(x, y)[0] > 0) {
                left = std::min(left, x);
                right = std::max(right, x + 1);
            }
    if (left >= right) return;
    const media::Image before = matte;
    const int shift = (direction < 4 ? 1 : -1) * static_cast<int>((right - left + 1) / 2);
    for (uint32_t y = 0; y < matte.height; ++y)
        for (uint32_t x = left; x < right; ++x) {
            const int to = static_cast<int>(x) + shift;
            if (to < 0 || to >= static_cast<int>(matte.width)) continue;
            uint8_t* pixel = matte.at(static_cast<uint32_t>(to), y);
            std::fill_n(pixel, 3, std::max(pixel[0], before.at(x, y)[0]));
        }
}

constexpr const char* kMatteFaultTexts[] = {"a limb is missing", "half of the body is missing",
                                            "too much: a second body"};  // by MatteFault

std::string plate_text(const StudioCamera& camera) {
    switch (camera.plate_fault) {
        case PlateFault::kNone:
            break;
        case PlateFault::kOfAnotherCamera:
            return "that of " + camera_name(camera.plate_of);
        case PlateFault::kGreen:
            return "green";
        case PlateFault::kMissing:
            return "missing";
    }
    return "right";
}

}  // namespace

const WrongMatte* Studio::wrong_matte(size_t camera, uint32_t frame) const {
    const auto found = std::ranges::find_if(
        wrong_mattes, [&](const WrongMatte& wrong) { return wrong.camera == camera && wrong.frame == frame; });
    return found == wrong_mattes.end() ? nullptr : &*found;
}

Studio make_studio(uint64_t seed, const std::vector<bool>& held_out, uint32_t frames) {
    Studio studio;
    studio.seed = seed;
    StudioDice dice(seed);
    std::vector<size_t> train;
    for (size_t c = 0; c < held_out.size(); ++c) {
        StudioCamera camera{.held_out = held_out[c], .filed_as = c};
        if (!held_out[c]) {
            train.push_back(c);
            for (double& gain : camera.gains) gain = dice.between(kLeastGain, kMostGain);
            for (double& share : camera.vignette) share = -dice.between(kMinLoss, kMaxLoss);
        }
        studio.cameras.push_back(camera);
    }
    assert(train.size() >= kMinStudioCameras && "enough cameras to confuse");
    confuse_cameras(studio, train, dice);
    choose_wrong_mattes(studio, train, frames, dice);
    return studio;
}

media::Image record(const Studio& studio, size_t camera, uint32_t frame, const media::Image& scene) {
    const StudioCamera& with = studio.cameras[camera];
    const uint64_t image_key = mixed(mixed(studio.seed + 1) ^ (camera << 32 | frame));
    media::Image recorded(scene.width, scene.height);
    for (uint32_t y = 0; y < scene.height; ++y)
        for (uint32_t x = 0; x < scene.width; ++x) {
            const double r2 = squared_radius(scene, x, y);
            const double vignette = 1 + with.vignette[0] * r2 + with.vignette[1] * r2 * r2;
            for (size_t c = 0; c < 3; ++c) {
                const auto light = static_cast<double>(media::linear_from_srgb_byte(scene.at(x, y)[c]));
                const double electrons = kFullWell_electrons * vignette * light;
                const double deviation = std::sqrt(electrons + kReadNoise_electrons * kReadNoise_electrons);
                const uint64_t key = image_key + ((size_t{y} * scene.width + x) * 3 + c) * 0x9e3779b97f4a7c15u;
                const double read = electrons + deviation * noise_of(key);
                recorded.at(x, y)[c] =
                    media::srgb_byte_from_linear(static_cast<float>(with.gains[c] * read / kFullWell_electrons));
            }
            recorded.at(x, y)[3] = 255;
        }
    return recorded;
}

media::Image studio_matte(const Studio& studio, size_t camera, uint32_t frame, const media::Image& scene) {
    constexpr double kLimb = 0.2, kHalf = 0.5;  // shares of the foreground
    media::Image matte(scene.width, scene.height);
    for (size_t i = 0; i < scene.rgba.size(); i += 4) {
        std::fill_n(&matte.rgba[i], 3, scene.rgba[i + 3]);
        matte.rgba[i + 3] = 255;
    }
    const WrongMatte* wrong = studio.wrong_matte(camera, frame);
    if (!wrong) return matte;
    if (wrong->fault == MatteFault::kTooMuch)
        add_second_body(matte, wrong->direction);
    else
        cut_off(matte, wrong->direction, wrong->fault == MatteFault::kLimbMissing ? kLimb : kHalf);
    return matte;
}

media::Image green_plate(uint32_t width, uint32_t height) {
    media::Image plate(width, height);
    for (size_t i = 0; i < plate.rgba.size(); ++i) plate.rgba[i] = i % 4 == 3 ? uint8_t{255} : kGreenCloth[i % 4];
    return plate;
}

void write_studio_truth(const std::filesystem::path& file, const Studio& studio) {
    nlohmann::ordered_json root = {{"seed", studio.seed},
                                   {"jpeg_quality", kStudioJpegQuality},
                                   {"full_well_electrons", kFullWell_electrons},
                                   {"read_noise_electrons", kReadNoise_electrons},
                                   {"swapped", nlohmann::ordered_json::array()},
                                   {"cameras", nlohmann::ordered_json::array()},
                                   {"wrong_mattes", nlohmann::ordered_json::array()}};
    for (size_t c = 0; c < studio.cameras.size(); ++c) {
        const StudioCamera& camera = studio.cameras[c];
        if (camera.filed_as != c) root["swapped"].push_back(camera_name(c));
        nlohmann::ordered_json entry = {{"name", camera_name(c)}, {"held_out", camera.held_out}};
        if (!camera.held_out) {
            entry["images_are_called"] = camera_name(camera.filed_as);
            entry["gains"] = camera.gains;
            entry["vignette"] = camera.vignette;
            entry["plate"] = plate_text(camera);
        }
        root["cameras"].push_back(std::move(entry));
    }
    for (const WrongMatte& wrong : studio.wrong_mattes)
        root["wrong_mattes"].push_back({{"file", image_name(studio.cameras[wrong.camera].filed_as, wrong.frame)},
                                        {"fault", kMatteFaultTexts[static_cast<size_t>(wrong.fault)]}});
    write_text_file(file, root.dump(2) + "\n");
}

}  // namespace neuvv::training
