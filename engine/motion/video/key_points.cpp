#include "motion/video/key_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/text.h"
#include "motion/skeleton/median.h"

namespace neuvv::motion {

namespace {

constexpr double kMaxPixel = 1e6;
constexpr size_t kMaxPeople = 1000, kMaxPoints = 1000;

KeyPoint read_point(const JsonNode& x, const JsonNode& y, const JsonNode& confidence) {
    KeyPoint point;
    point.pixel = {json_number(x, -kMaxPixel, kMaxPixel, "a pixel"), json_number(y, -kMaxPixel, kMaxPixel, "a pixel")};
    // Some detectors give scores a little above 1.
    point.confidence = std::clamp(json_number(confidence, -1e3, 1e3, "a confidence"), 0.0, 1.0);
    return point;
}

// OpenPose's and AlphaPose's list x, y, confidence, x, ...
std::vector<KeyPoint> read_flat_points(const JsonNode& list) {
    if (list.value.is_array() && list.value.empty()) return {};
    expect_list(list);
    if (list.value.size() > 3 * kMaxPoints) list.fail(fmt::format("has more than {} key points", kMaxPoints));
    if (list.value.size() % 3 != 0) list.fail("is no list of x, y, confidence");
    std::vector<KeyPoint> points;
    for (size_t i = 0; i < list.value.size(); i += 3) points.push_back(read_point(list[i], list[i + 1], list[i + 2]));
    return points;
}

// MMPose's lists [[x, y], ...] and [confidence, ...].
std::vector<KeyPoint> read_paired_points(const JsonNode& places, const JsonNode& scores) {
    expect_list(places);
    if (places.value.size() > kMaxPoints) places.fail(fmt::format("has more than {} key points", kMaxPoints));
    expect_array(scores, places.value.size());
    std::vector<KeyPoint> points;
    for (size_t i = 0; i < places.value.size(); ++i) {
        expect_list(places[i]);
        if (places[i].value.size() < 2) places[i].fail("is no place [x, y]");
        points.push_back(read_point(places[i][size_t{0}], places[i][size_t{1}], scores[i]));
    }
    return points;
}

bool has(const JsonNode& node, const char* member) {
    return node.value.is_object() && node.value.contains(member);
}

std::vector<KeyPoint> read_person(const JsonNode& node) {
    if (has(node, "keypoint_scores")) return read_paired_points(node["keypoints"], node["keypoint_scores"]);
    return read_flat_points(node[has(node, "keypoints") ? "keypoints" : "pose_keypoints_2d"]);
}

double confidence_of(const std::vector<KeyPoint>& points) {
    double sum = 0;
    for (const KeyPoint& point : points) sum += point.confidence;
    return sum;
}

// Adds a person to an image, where the most confident one stands first. Some detectors leave empty lists where nobody
// was seen.
void add_person(const JsonNode& node, ImagePeople& image) {
    std::vector<KeyPoint> points = read_person(node);
    if (points.empty()) return;
    if (image.people.size() == kMaxPeople) node.fail("is beyond 1000 people");
    if (!find_key_point_layout(points.size()))
        node.fail(fmt::format("has {} key points", points.size()),
                  "use a detector of one of these sets: " + key_point_layouts());
    if (!image.people.empty() && image.people[0].size() != points.size())
        node.fail(fmt::format("has {} key points, the person before it {}", points.size(), image.people[0].size()),
                  "use one detector");
    const auto less_sure = std::ranges::find_if(
        image.people, [sure = confidence_of(points)](const auto& other) { return confidence_of(other) < sure; });
    image.people.insert(less_sure, std::move(points));
}

ImagePeople people_of(const JsonNode& list, std::string name) {
    if (!list.value.is_array()) list.fail_type("a list");
    ImagePeople image{std::move(name), {}};
    for (size_t i = 0; i < list.value.size(); ++i) add_person(list[i], image);
    return image;
}

// The people of a video's frames, as MMPose writes them.
std::vector<ImagePeople> people_of_frames(const JsonNode& frames) {
    if (!frames.value.is_array()) frames.fail_type("a list");
    std::vector<ImagePeople> images;
    for (size_t i = 0; i < frames.value.size(); ++i) {
        const uint64_t number = json_count(frames[i]["frame_id"], uint64_t{1} << 40);
        images.push_back(people_of(frames[i]["instances"], std::to_string(number)));
    }
    return images;
}

// AlphaPose's list of all people of all images.
std::vector<ImagePeople> people_by_image(const JsonNode& list) {
    std::vector<ImagePeople> images;
    for (size_t i = 0; i < list.value.size(); ++i) {
        const JsonNode id = list[i]["image_id"];
        if (!id.value.is_string() && !id.value.is_number_unsigned()) id.fail("is no image's name");
        const std::string name = id.value.is_string()
                                     ? std::filesystem::path(id.value.get<std::string>()).stem().string()
                                     : std::to_string(id.value.get<uint64_t>());
        // People of one image stand together.
        if (images.empty() || images.back().image != name) images.push_back({name, {}});
        add_person(list[i], images.back());
    }
    return images;
}

KeyPoint joint_point(const std::vector<KeyPoint>& points, std::array<int, 2> sources) {
    if (sources[0] < 0) return {};
    const KeyPoint& a = points[static_cast<size_t>(sources[0])];
    const KeyPoint& b = points[static_cast<size_t>(sources[1])];
    return {0.5 * (a.pixel + b.pixel), std::min(a.confidence, b.confidence)};
}

// How far a key point is from the centre of two others, as a share of the body's size in the image; nothing where one
// of them was not seen.
std::optional<double> off_centre(const std::vector<KeyPoint>& points, size_t centre, size_t one, size_t other) {
    glm::dvec2 low(kMaxPixel), high(-kMaxPixel);
    for (const KeyPoint& point : points) {
        if (!(point.confidence > 0)) continue;
        low = glm::min(low, point.pixel);
        high = glm::max(high, point.pixel);
    }
    for (const size_t i : {centre, one, other})
        if (!(points[i].confidence > 0)) return std::nullopt;
    const double size = glm::distance(low, high);
    if (!(size > 0)) return std::nullopt;
    return glm::distance(points[centre].pixel, 0.5 * (points[one].pixel + points[other].pixel)) / size;
}

// Key points that lie between two others: of a set that is not the right one, they lie elsewhere.
struct Between {
    size_t centre, one, other;
};

// The farthest that these are from where they belong, in the median of all people; nothing where none was seen.
std::optional<double> misplacement(std::span<const ImagePeople> images, std::span<const Between> points) {
    std::optional<double> most;
    for (const auto& [centre, one, other] : points) {
        std::vector<double> off;
        for (const ImagePeople& image : images)
            for (const std::vector<KeyPoint>& person : image.people) {
                if (person.size() <= std::max({centre, one, other})) continue;  // of another set
                if (const auto found = off_centre(person, centre, one, other)) off.push_back(*found);
            }
        if (!off.empty()) most = std::max(most.value_or(0), median(off));
    }
    return most;
}

// BODY_25 and BODY_25B have 25 points each. In the former, pelvis and neck are between hips and shoulders; in the
// latter, the nose is between eyes and between ears, and the neck, of another number, between the shoulders. Null where
// neither is clear.
const KeyPointLayout* layout_of_25(std::span<const ImagePeople> images) {
    constexpr double kTogether = 0.08, kClearly = 1.5;
    constexpr Between kOf25[] = {{8, 9, 12}, {1, 2, 5}}, kOf25B[] = {{17, 5, 6}, {0, 1, 2}, {0, 3, 4}};
    const double of_25 = misplacement(images, kOf25).value_or(1), of_25b = misplacement(images, kOf25B).value_or(1);
    if (!(std::min(of_25, of_25b) < kTogether && std::max(of_25, of_25b) > kClearly * kTogether)) return nullptr;
    return find_key_point_layout(of_25 < of_25b ? "BODY_25" : "BODY_25B");
}

}  // namespace

std::string image_of_key_points(const std::filesystem::path& file) {
    std::string name = file.stem().string();
    const std::string ending = kKeyPointEnding;
    if (name.ends_with(ending)) name.resize(name.size() - ending.size());
    for (const std::string type : {".png", ".jpg", ".jpeg"})
        if (name.size() > type.size() && lower_case(name).ends_with(type)) name.resize(name.size() - type.size());
    return name;
}

KeyPointFile read_key_points(const std::filesystem::path& file) {
    const JsonFile json = read_json_value(file);
    const JsonNode root = json.root();
    if (!root.value.is_object() && !root.value.is_array())
        root.fail("is neither a JSON object nor a list", "give key points of a detector");
    if (has(root, "instance_info")) return {people_of_frames(root["instance_info"]), true};
    if (!root.value.is_array()) return {{people_of(root["people"], image_of_key_points(file))}, false};
    if (!root.value.empty() && has(root[size_t{0}], "image_id")) return {people_by_image(root), true};
    if (!root.value.empty() && has(root[size_t{0}], "instances")) return {people_of_frames(root), true};
    return {{people_of(root, image_of_key_points(file))}, false};
}

const KeyPointLayout* layout_of(std::span<const ImagePeople> images) {
    const auto seen = std::ranges::find_if(images, [](const ImagePeople& image) { return !image.people.empty(); });
    if (seen == images.end()) return nullptr;
    const KeyPointLayout* layout = find_key_point_layout(seen->people[0].size());
    return layout == find_key_point_layout("BODY_25") ? layout_of_25(images) : layout;
}

KeyPoints joints_of(const std::vector<KeyPoint>& points, const KeyPointLayout& layout) {
    KeyPoints joints;
    for (size_t j = 0; j < kJoints; ++j) joints[j] = joint_point(points, layout.sources[j]);
    return joints;
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
