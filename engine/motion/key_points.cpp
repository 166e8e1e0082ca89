#include "motion/key_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>

#include "base/error.h"
#include "base/json.h"
#include "base/output_path.h"

namespace neuvv::motion {

namespace {

constexpr double kMaxPixel = 1e6;
constexpr size_t kMaxPeople = 1000, kMaxPoints = 1000;
const std::string kKeyPointEnding = "_keypoints";  // of a file's name, after that of its image

struct Person {
    std::vector<KeyPoint> points;
    double confidence = 0;  // the sum
};

Person read_person(const JsonNode& node) {
    const JsonNode list = node["pose_keypoints_2d"];
    expect_list(list);
    if (list.value.size() > 3 * kMaxPoints) list.fail(fmt::format("has more than {} key points", kMaxPoints));
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

// What a folder contains, by name. Throws InputError where it cannot be read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder) {
    std::vector<std::filesystem::directory_entry> entries;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        entries.push_back(*at);
    if (error) throw InputError(folder.string(), "", "cannot be read: " + error.message());
    std::ranges::sort(entries);
    return entries;
}

// The number that a name ends with, or 0.
size_t last_number(const std::string& name) {
    size_t end = name.size();
    while (end > 0 && !std::isdigit(static_cast<unsigned char>(name[end - 1]))) --end;
    size_t begin = end;
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(name[begin - 1]))) --begin;
    size_t number = 0;
    std::from_chars(name.data() + begin, name.data() + end, number);
    return number;
}

// The files of a folder that end with .json, by the numbers that their names end with: f9 before f10.
std::vector<std::filesystem::path> json_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (const auto& entry : entries_of(folder))
        if (entry.path().extension() == ".json" && entry.is_regular_file(ignored)) files.push_back(entry.path());
    std::ranges::stable_sort(files, {}, [](const auto& file) { return last_number(file.stem().string()); });
    return files;
}

std::string image_of(const std::filesystem::path& file) {
    std::string name = file.stem().string();
    if (name.ends_with(kKeyPointEnding)) name.resize(name.size() - kKeyPointEnding.size());
    return name;
}

// Throws InputError where two images have one name.
std::map<std::string, size_t> images_by_name(const std::filesystem::path& folder, std::span<const WantedImage> images) {
    std::map<std::string, size_t> by_name;
    for (size_t i = 0; i < images.size(); ++i)
        if (!by_name.emplace(images[i].image, i).second)
            throw InputError(folder.string(), "",
                             fmt::format("images of several cameras are called \"{}\"", images[i].image),
                             "give a folder for each camera: CAMERA_json");
    return by_name;
}

// The file of each wanted image, in a folder of them all.
std::vector<std::filesystem::path> flat_files(const std::filesystem::path& folder,
                                              std::span<const WantedImage> images) {
    const std::map<std::string, size_t> by_name = images_by_name(folder, images);
    std::vector<std::filesystem::path> found(images.size());
    for (const std::filesystem::path& file : json_files(folder)) {
        const auto image = by_name.find(image_of(file));
        if (image == by_name.end())
            throw InputError(file.string(), "", "belongs to no image of these cameras",
                             "remove it, or name it like its image");
        found[image->second] = file;
    }
    return found;
}

// The images of each camera, in order of their frames.
std::map<std::string, std::vector<size_t>> images_by_camera(std::span<const WantedImage> images) {
    std::map<std::string, std::vector<size_t>> cameras;
    for (size_t i = 0; i < images.size(); ++i) cameras[images[i].camera].push_back(i);
    for (auto& [camera, list] : cameras) std::ranges::sort(list, {}, [&](size_t i) { return images[i].frame; });
    return cameras;
}

// The file of each wanted image, in a folder for each camera.
std::vector<std::filesystem::path> files_by_camera(const std::filesystem::path& folder,
                                                   std::span<const WantedImage> images) {
    const std::map<std::string, std::vector<size_t>> cameras = images_by_camera(images);
    std::vector<std::filesystem::path> found(images.size());
    std::map<std::string, std::filesystem::path> folders;
    std::error_code ignored;
    for (const auto& entry : entries_of(folder)) {
        if (!entry.is_directory(ignored)) continue;
        std::string name = entry.path().filename().string();
        if (name.ends_with("_json")) name.resize(name.size() - 5);
        const auto camera = cameras.find(name);
        if (camera == cameras.end())
            throw InputError(entry.path().string(), "", "belongs to none of these cameras",
                             fmt::format("remove it, or name it like its camera: {}_json", cameras.begin()->first));
        if (const auto [other, added] = folders.emplace(name, entry.path()); !added)
            throw InputError(entry.path().string(), "", "is of the same camera as " + other->second.string(),
                             "remove one of them");
        const std::vector<std::filesystem::path> files = json_files(entry.path());
        if (files.size() > camera->second.size())
            throw InputError(entry.path().string(), "",
                             fmt::format("has {} frames, but the camera has {}", files.size(), camera->second.size()),
                             "detect key points in the images of these cameras alone");
        for (size_t i = 0; i < files.size(); ++i) found[camera->second[i]] = files[i];
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
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
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
        throw InputError(folder.string(), "", "has no key points of these images",
                         "name files like the images: c00_f000_keypoints.json");
    for (size_t j = 0; j < kJoints; ++j) {
        detections.lacking[j] = layout->sources[j][0] < 0;
    }
}

std::vector<std::filesystem::path> key_point_files(const std::filesystem::path& folder,
                                                   std::span<const WantedImage> images) {
    images_by_name(folder, images);
    std::vector<std::filesystem::path> files;
    for (const WantedImage& image : images) files.push_back(folder / (image.image + kKeyPointEnding + ".json"));
    return files;
}

void write_person(const std::filesystem::path& file, std::span<const KeyPoint> points) {
    std::vector<double> numbers;
    for (const KeyPoint& point : points)
        numbers.insert(numbers.end(), {point.pixel.x, point.pixel.y, point.confidence});
    nlohmann::ordered_json people = nlohmann::ordered_json::array();
    if (!points.empty()) people.push_back({{"pose_keypoints_2d", numbers}});
    write_text_file(file, nlohmann::ordered_json({{"version", 1.3}, {"people", people}}).dump() + "\n");
}

void write_key_points(const std::filesystem::path& file, const KeyPoints& points) {
    const KeyPointLayout& layout = *find_key_point_layout(25);
    std::vector<KeyPoint> all(layout.points);
    for (size_t j = 0; j < kJoints; ++j) all[static_cast<size_t>(layout.sources[j][0])] = points[j];
    write_person(file, all);
}

}  // namespace neuvv::motion
