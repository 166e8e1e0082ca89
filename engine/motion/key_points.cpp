#include "motion/key_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/json.h"
#include "base/output_path.h"

namespace neuvv::motion {

namespace {

constexpr double kMaxPixel = 1e6;
constexpr size_t kMaxPeople = 1000;

struct Person {
    std::vector<KeyPoint> points;
    double confidence = 0;  // the sum
};

Person read_person(const JsonNode& node) {
    const JsonNode list = node["pose_keypoints_2d"];
    expect_list(list);
    if (list.value.size() % 3 != 0) list.fail("is no list of x, y, confidence");
    Person person;
    for (size_t i = 0; i < list.value.size(); i += 3) {
        KeyPoint point;
        point.pixel = {json_number(list[i], -kMaxPixel, kMaxPixel, "a pixel"),
                       json_number(list[i + 1], -kMaxPixel, kMaxPixel, "a pixel")};
        // Some detectors give scores a little above 1.
        point.confidence = std::clamp(json_number(list[i + 2], -1e3, 1e3, "a confidence"), 0.0, 1.0);
        person.confidence += point.confidence;
        person.points.push_back(point);
    }
    return person;
}

KeyPoint joint_point(const Person& person, std::array<int, 2> sources) {
    if (sources[0] < 0) return {};
    const KeyPoint& a = person.points[static_cast<size_t>(sources[0])];
    const KeyPoint& b = person.points[static_cast<size_t>(sources[1])];
    return {0.5 * (a.pixel + b.pixel), std::min(a.confidence, b.confidence)};
}

// The files of a folder that end with .json, by name.
std::vector<std::filesystem::path> json_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".json" && entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

std::string image_of(const std::filesystem::path& file) {
    std::string name = file.stem().string();
    constexpr std::string_view kEnding = "_keypoints";
    if (name.ends_with(kEnding)) name.resize(name.size() - kEnding.size());
    return name;
}

// The file of each wanted image, in a folder of them all.
std::vector<std::filesystem::path> flat_files(const std::filesystem::path& folder,
                                              std::span<const WantedImage> images) {
    std::map<std::string, size_t> by_name;
    for (size_t i = 0; i < images.size(); ++i) by_name[images[i].image] = i;
    std::vector<std::filesystem::path> found(images.size());
    for (const std::filesystem::path& file : json_files(folder)) {
        const auto image = by_name.find(image_of(file));
        if (image == by_name.end())
            throw InputError(file.string(), "", "belongs to no image of the rendered views",
                             "remove it, or name it like its image");
        found[image->second] = file;
    }
    return found;
}

// The same in a folder for each camera.
std::vector<std::filesystem::path> files_by_camera(const std::filesystem::path& folder,
                                                   std::span<const WantedImage> images) {
    std::map<std::string, std::vector<std::filesystem::path>> by_camera;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (!entry.is_directory()) continue;
        std::string name = entry.path().filename().string();
        if (name.ends_with("_json")) name.resize(name.size() - 5);
        if (std::ranges::find(images, name, &WantedImage::camera) == images.end())
            throw InputError(entry.path().string(), "", "belongs to no camera of the rendered views",
                             "remove it, or name it like its camera");
        by_camera[name] = json_files(entry.path());
    }
    std::vector<std::filesystem::path> found(images.size());
    for (size_t i = 0; i < images.size(); ++i) {
        const std::vector<std::filesystem::path>& files = by_camera[images[i].camera];
        if (images[i].frame < files.size()) found[i] = files[images[i].frame];
    }
    for (const auto& [camera, files] : by_camera) {
        const auto frames = std::ranges::count(images, camera, &WantedImage::camera);
        if (files.size() > static_cast<size_t>(frames))
            throw InputError((folder / camera).string(), "",
                             fmt::format("has {} frames, but the camera has {}", files.size(), frames),
                             "detect key points in the images of `neuvv skeleton views` alone");
    }
    return found;
}

}  // namespace

DetectedImage read_key_points(const std::filesystem::path& file) {
    const JsonFile json = read_json(file, "key points of a detector");
    const JsonNode people = json.root()["people"];
    if (!people.value.is_array()) people.fail_type("a list");
    if (people.value.size() > kMaxPeople) people.fail("has more than 1000 people");
    DetectedImage image;
    image.people = people.value.size();
    double best = -1;
    for (size_t i = 0; i < people.value.size(); ++i) {
        const Person person = read_person(people[i]);
        const KeyPointLayout* layout = find_key_point_layout(person.points.size());
        if (!layout)
            people[i].fail(fmt::format("has {} key points", person.points.size()),
                           "use a detector of one of these sets: " + key_point_layouts());
        if (person.confidence <= best) continue;
        best = person.confidence;
        image.layout = layout;
        for (size_t j = 0; j < kJoints; ++j) image.points[j] = joint_point(person, layout->sources[j]);
    }
    return image;
}

void read_detections(const std::filesystem::path& folder, std::span<const WantedImage> images, Detections& detections) {
    if (!std::filesystem::is_directory(folder))
        throw InputError(folder.string(), "", "is no folder of key points",
                         "run a detector on the images and write its JSON there");
    const bool flat = !json_files(folder).empty();
    const std::vector<std::filesystem::path> files =
        flat ? flat_files(folder, images) : files_by_camera(folder, images);
    detections.points.assign(detections.frames * detections.cameras.size(), {});
    const KeyPointLayout* layout = nullptr;
    for (size_t i = 0; i < images.size(); ++i) {
        if (files[i].empty()) continue;
        const DetectedImage image = read_key_points(files[i]);
        detections.images_with_others += image.people > 1;
        if (!image.layout) continue;
        if (layout && layout != image.layout)
            throw InputError(files[i].string(), "",
                             fmt::format("is of the set {}, others are of {}", image.layout->name, layout->name),
                             "use one detector for all images");
        layout = image.layout;
        detections.in(images[i].frame, images[i].camera_index) = image.points;
    }
    if (!layout)
        throw InputError(folder.string(), "", "has no key points of the rendered views",
                         "name files like the images: c00_f000_keypoints.json");
    for (size_t j = 0; j < kJoints; ++j) {
        const auto [first, second] = layout->sources[j];
        detections.estimated[j] = first != second;
        detections.lacking[j] = first < 0;
    }
}

void write_key_points(const std::filesystem::path& file, const KeyPoints& points) {
    const KeyPointLayout& layout = *find_key_point_layout(25);
    std::vector<double> numbers(3 * layout.points, 0.0);
    for (size_t j = 0; j < kJoints; ++j) {
        const auto at = 3 * static_cast<size_t>(layout.sources[j][0]);
        numbers[at] = points[j].pixel.x;
        numbers[at + 1] = points[j].pixel.y;
        numbers[at + 2] = points[j].confidence;
    }
    const nlohmann::ordered_json json = {{"version", 1.3}, {"people", {{{"pose_keypoints_2d", numbers}}}}};
    write_text_file(file, json.dump() + "\n");
}

}  // namespace neuvv::motion
