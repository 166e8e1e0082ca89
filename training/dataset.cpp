#include "training/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "base/platform.h"
#include "training/transforms.h"

namespace neuvv {

namespace {

constexpr uint64_t kMaxImageFileBytes = uint64_t{1} << 30;
constexpr uint32_t kHoldOut = 8;  // of one transforms.json, every 8th camera is for the test

// What makes two frames the same camera: pose and intrinsics as the file gives them.
using CameraIdentity = std::array<double, 19>;

CameraIdentity identity(const TransformsFrame& frame) {
    constexpr double kAbsent = std::numeric_limits<double>::infinity();
    const Intrinsics& in = frame.intrinsics;
    CameraIdentity key{};
    for (int i = 0; i < 12; ++i) key[static_cast<size_t>(i)] = frame.world_from_camera[i / 3][i % 3];
    const std::array rest{in.fl_x.value_or(kAbsent), in.camera_angle_x.value_or(kAbsent),
                          in.fl_y.value_or(kAbsent), in.cx.value_or(kAbsent),
                          in.cy.value_or(kAbsent),   double{1.0 * in.width},
                          double{1.0 * in.height}};
    std::copy(rest.begin(), rest.end(), key.begin() + 12);
    return key;
}

// Each frame's camera, numbered in order of first use.
std::vector<uint32_t> number_cameras(const std::vector<TransformsFrame>& frames) {
    std::map<CameraIdentity, uint32_t> seen;
    std::vector<uint32_t> cameras;
    cameras.reserve(frames.size());
    for (const TransformsFrame& frame : frames)
        cameras.push_back(seen.try_emplace(identity(frame), static_cast<uint32_t>(seen.size())).first->second);
    return cameras;
}

// The file of a split, with only that split's frames in it.
std::pair<std::filesystem::path, Transforms> read_split(const std::filesystem::path& folder, Split split) {
    const bool test = split == Split::kTest;
    const auto train_file = folder / "transforms_train.json", test_file = folder / "transforms_test.json";
    const auto single_file = folder / "transforms.json";
    std::error_code ignored;
    if (std::filesystem::exists(train_file, ignored) || std::filesystem::exists(test_file, ignored)) {
        const auto file = test ? test_file : train_file;
        return {file, read_transforms(file)};
    }
    if (!std::filesystem::exists(single_file, ignored))
        throw InputError(folder.string(), "", "holds no transforms_train.json and no transforms.json",
                         "name the folder of a data set of the NeRF family");
    Transforms all = read_transforms(single_file);
    const std::vector<uint32_t> cameras = number_cameras(all.frames);
    if (*std::max_element(cameras.begin(), cameras.end()) == 0)
        throw InputError(single_file.string(), "frames", "has one camera, and one must be held out for the test",
                         "give two cameras or more, or transforms_train.json and transforms_test.json");
    std::vector<TransformsFrame> kept;
    for (size_t i = 0; i < all.frames.size(); ++i)
        if ((cameras[i] % kHoldOut == 0) == test) kept.push_back(std::move(all.frames[i]));
    all.frames = std::move(kept);
    return {single_file, std::move(all)};
}

// `path` as given, else with ".png".
std::filesystem::path find_picture(const std::filesystem::path& folder, const std::string& path,
                                   const std::string& file, const std::string& place) {
    std::error_code ignored;
    for (const char* ending : {"", ".png"}) {
        std::filesystem::path candidate = folder / (path + ending);
        if (std::filesystem::is_regular_file(candidate, ignored)) return candidate;
    }
    throw InputError(file, place, fmt::format("there is no picture {0} nor {0}.png", (folder / path).string()),
                     "put it there or correct the path");
}

// A data set's files while it is being read.
struct Sources {
    std::string file;  // the transforms.json
    std::vector<TransformsFrame> frames;
    std::vector<std::filesystem::path> pictures;  // by view
    std::vector<std::filesystem::path> plates;    // by camera, empty: none
    std::vector<size_t> first_frame;              // by camera

    [[noreturn]] void fail(size_t frame, const std::string& field, const std::string& problem,
                           const std::string& mend) const {
        throw InputError(file, frames[frame].place + field, problem, mend);
    }
};

void find_files(Sources& sources, const Dataset& dataset) {
    std::map<std::filesystem::path, size_t> seen;
    std::map<std::pair<uint32_t, double>, size_t> instants;
    for (size_t i = 0; i < sources.frames.size(); ++i) {
        const TransformsFrame& frame = sources.frames[i];
        const uint32_t camera = dataset.views[i].camera;
        if (frame.file_path.empty()) sources.fail(i, "", "has no file_path", "name its picture");
        const auto picture = find_picture(dataset.folder, frame.file_path, sources.file, frame.place + ".file_path");
        const auto [same, fresh] = seen.try_emplace(picture.lexically_normal(), i);
        if (!fresh)
            sources.fail(i, ".file_path", "is the picture of " + sources.frames[same->second].place + " again",
                         "give each frame its own picture");
        const auto [twin, alone] = instants.try_emplace({camera, dataset.views[i].time}, i);
        if (!alone)
            sources.fail(i, "", "has the camera and the time of " + sources.frames[twin->second].place,
                         "remove the duplicate, or give each frame its time");
        sources.pictures.push_back(picture);

        if (camera == sources.first_frame.size()) {
            sources.first_frame.push_back(i);
            sources.plates.push_back(frame.background_path.empty()
                                         ? std::filesystem::path()
                                         : find_picture(dataset.folder, frame.background_path, sources.file,
                                                        frame.place + ".background_path"));
        }
        const TransformsFrame& first = sources.frames[sources.first_frame[camera]];
        if (frame.background_path != first.background_path)
            sources.fail(i, ".background_path", "differs from that of the same camera in " + first.place,
                         "give one clean plate to all frames of a camera, or none");
    }
}

void number_times(Sources& sources, Dataset& dataset) {
    const bool timed = sources.frames[0].time.has_value();
    std::set<double> times;
    for (size_t i = 0; i < sources.frames.size(); ++i) {
        if (sources.frames[i].time.has_value() != timed)
            sources.fail(timed ? i : 0, "", "has no time, but other frames have one", "give it to all frames or none");
        dataset.views[i].time = sources.frames[i].time.value_or(0);
        times.insert(dataset.views[i].time);
    }
    dataset.times.assign(times.begin(), times.end());
}

Image load_picture(const std::filesystem::path& path) {
    const std::vector<uint8_t> bytes = read_file(path, kMaxImageFileBytes);
    return decode_image(bytes.data(), bytes.size(), path.string());
}

void load_pictures(const Sources& sources, Dataset& dataset) {
    const size_t views = dataset.views.size();
    const auto load = [&](size_t i) {
        const auto& path = i < views ? sources.pictures[i] : sources.plates[i - views];
        if (path.empty()) return;
        const size_t frame = i < views ? i : sources.first_frame[i - views];
        const Intrinsics& in = sources.frames[frame].intrinsics;
        Image image = load_picture(path);
        if (in.width != 0 && (image.width != in.width || image.height != in.height))
            throw InputError(path.string(), "",
                             fmt::format("is {}×{}, but {} of {} says {}×{}", image.width, image.height,
                                         sources.frames[frame].place, sources.file, in.width, in.height),
                             "correct w and h, and fl_x, fl_y, cx, cy with them");
        (i < views ? dataset.views[i].image : dataset.plates[i - views]) = std::move(image);
    };
    parallel_for(views + dataset.plates.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) load(i);
    });
}

// Where the file gives no size, a camera takes that of its first picture; the others must follow it.
void make_cameras(const Sources& sources, Dataset& dataset) {
    for (const size_t frame : sources.first_frame) {
        const Image& image = dataset.views[frame].image;
        dataset.cameras.push_back(make_camera(sources.frames[frame], image.width, image.height));
    }
    const auto expect_size = [&](const Image& image, const Camera& camera, const std::filesystem::path& path) {
        if (image.width != camera.width || image.height != camera.height)
            throw InputError(path.string(), "",
                             fmt::format("is {}×{}, but the first picture of its camera {}×{}", image.width,
                                         image.height, camera.width, camera.height),
                             "give all pictures of a camera one size");
    };
    for (size_t i = 0; i < dataset.views.size(); ++i)
        expect_size(dataset.views[i].image, dataset.cameras[dataset.views[i].camera], sources.pictures[i]);
    for (size_t i = 0; i < dataset.plates.size(); ++i)
        if (!sources.plates[i].empty()) expect_size(dataset.plates[i], dataset.cameras[i], sources.plates[i]);
}

void expect_matte(const Sources& sources, const Dataset& dataset) {
    bool clear = false, solid = false;
    for (const View& view : dataset.views)
        for (size_t i = 3; i < view.image.rgba.size() && !(clear && solid); i += 4) {
            clear |= view.image.rgba[i] != 255;
            solid |= view.image.rgba[i] != 0;
        }
    if (!clear)
        throw InputError(sources.file, "frames[].file_path", "no picture has a matte: every alpha is 255",
                         "give RGBA PNGs whose alpha is 255 on the performer and 0 elsewhere");
    if (!solid)
        throw InputError(sources.file, "frames[].file_path", "every alpha of every picture is 0",
                         "give RGBA PNGs whose alpha is 255 on the performer and 0 elsewhere");
}

}  // namespace

Dataset load_dataset(const std::filesystem::path& folder, Split split) {
    Dataset dataset;
    dataset.folder = folder;
    Sources sources;
    auto [file, transforms] = read_split(folder, split);
    sources.file = file.string();
    sources.frames = std::move(transforms.frames);
    dataset.box = transforms.box;
    dataset.fps = transforms.fps;
    dataset.views.resize(sources.frames.size());
    const std::vector<uint32_t> cameras = number_cameras(sources.frames);
    for (size_t i = 0; i < cameras.size(); ++i) dataset.views[i].camera = cameras[i];
    number_times(sources, dataset);
    find_files(sources, dataset);
    for (size_t i = 0; i < cameras.size(); ++i) dataset.views[i].name = sources.pictures[i].stem().string();
    dataset.plates.resize(sources.plates.size());
    load_pictures(sources, dataset);
    make_cameras(sources, dataset);
    expect_matte(sources, dataset);
    return dataset;
}

std::vector<CameraKey> load_camera_path(const std::filesystem::path& file) {
    std::vector<CameraKey> keys;
    for (const TransformsFrame& frame : read_transforms(file).frames) {
        const Intrinsics& in = frame.intrinsics;
        const bool sized = in.width != 0;
        if (!sized && (in.fl_x || in.fl_y || in.cx || in.cy))
            throw InputError(file.string(), frame.place,
                             "fl_x, fl_y, cx, cy are in pixels of a picture of unknown size",
                             "give w and h, or camera_angle_x alone");
        CameraKey key{make_camera(frame, in.width, in.height), frame.time};
        if (!sized) key.camera.fx = key.camera.fy = 0.5 / std::tan(0.5 * in.camera_angle_x.value());
        keys.push_back(key);
    }
    return keys;
}

double frame_of_time(double time, uint32_t frames) {
    const double frame = time * (frames - 1), whole = std::round(frame);
    return std::abs(frame - whole) < 1e-3 ? whole : frame;
}

glm::vec4 foreground(const Dataset& dataset, const View& view, uint32_t x, uint32_t y) {
    const auto rgb = [](const uint8_t* at) {
        return glm::vec3(linear_from_srgb_byte(at[0]), linear_from_srgb_byte(at[1]), linear_from_srgb_byte(at[2]));
    };
    const uint8_t* pixel = view.image.at(x, y);
    const float alpha = static_cast<float>(pixel[3]) / 255.0f;
    const Image& plate = dataset.plates[view.camera];
    if (plate.width == 0) return {rgb(pixel) * alpha, alpha};
    // captured = foreground + (1 − α) background
    const glm::vec3 premultiplied = rgb(pixel) - (1 - alpha) * rgb(plate.at(x, y));
    return {glm::clamp(premultiplied, 0.0f, alpha), alpha};
}

}  // namespace neuvv
