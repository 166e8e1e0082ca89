// Reading TRC, a table of markers that OpenSim, Pose2Sim and motion capture systems write: five lines of header, then a
// line for each frame with its number, its time, and x, y, z of each marker. Tabs part the fields; lines without tabs
// are parted by spaces.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "base/text.h"
#include "motion/skeleton/bone_names.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/skeleton/words.h"

namespace neuvv::motion {

namespace {

constexpr double kMaxPlace = 1e7;

// The joint of each marker, by its name.
std::vector<std::optional<size_t>> joints_of_markers(const std::vector<std::string>& names) {
    using enum Joint;
    constexpr std::pair<BoneKind, Joint> kMiddle[] = {{kPelvisBone, kPelvis}, {kNeckBone, kNeck}, {kNoseBone, kNose}};
    constexpr std::pair<BoneKind, Joint> kRight[] = {
        {kUpperArm, kRightShoulder}, {kForearm, kRightElbow}, {kHand, kRightWrist},
        {kThigh, kRightHip},         {kShin, kRightKnee},     {kFoot, kRightAnkle},
        {kHeel, kRightHeel},         {kBigToe, kRightBigToe}, {kSmallToe, kRightSmallToe}};
    const FoundBones found = find_bones(names);
    std::vector<std::optional<size_t>> joints(names.size());
    for (const auto& [bone, joint] : kMiddle)
        if (found.has(bone)) joints[found.of(bone)] = index_of(joint);
    for (const auto& [bone, joint] : kRight) {
        if (found.has(bone, Side::kRight)) joints[found.of(bone, Side::kRight)] = index_of(joint);
        if (found.has(bone, Side::kLeft)) joints[found.of(bone, Side::kLeft)] = index_of(info_of(joint).mirrored);
    }
    return joints;
}

// Sets of markers without a pelvis or a neck have hips and shoulders, between which these lie.
void set_middle(Pose& pose, Joint middle, Joint right, Joint left) {
    if (at(pose, middle).confidence > 0) return;
    const JointSample &a = at(pose, right), &b = at(pose, left);
    if (a.confidence > 0 && b.confidence > 0) at(pose, middle) = {0.5 * (a.position + b.position), 1, true};
}

double metres_of(const Words& words, const std::string& written) {
    const std::string unit = lower_case(written);
    if (unit == "m" || unit == "meters" || unit == "metres") return 1;
    if (unit == "cm") return 0.01;
    if (unit == "mm") return 0.001;
    words.fail(fmt::format("\"{}\" is no unit that this program knows", unit.substr(0, 40)), "write m, cm or mm");
}

std::optional<double> number_in(const std::string& field) {
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size() || !(std::abs(value) <= kMaxPlace))
        return std::nullopt;
    return value;
}

std::vector<std::string> fields_of(const std::string& line) {
    const bool tabs = line.find('\t') != std::string::npos;
    std::vector<std::string> fields;
    for (const std::string& field : split(line, tabs ? '\t' : ' ')) {
        const size_t first = field.find_first_not_of(' ');
        if (first != std::string::npos)
            fields.push_back(field.substr(first, field.find_last_not_of(' ') + 1 - first));
        else if (tabs)
            fields.emplace_back();
    }
    if (fields.empty()) fields.emplace_back();
    return fields;
}

// Pose2Sim writes (y, z, x) of the world of its calibration into the folder pose-3d of a trial. Readers of data sets
// turn that world to (x, z, −y).
bool is_of_pose2sim(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::absolute(file, ignored).parent_path().filename() == "pose-3d";
}

void turn_to_cameras(SkeletonClip& clip) {
    for (Pose& pose : clip.frames)
        for (JointSample& sample : pose) sample.position = {sample.position.z, sample.position.y, -sample.position.x};
}

struct TrcHeader {
    double fps = 0, unit_m = 1;
    std::vector<std::optional<size_t>> joints;  // by marker
};

TrcHeader read_header_lines(Words& words) {
    const auto fields = [&] {
        std::string line;
        if (!words.line(line)) words.fail("the file ends in its header", "write it again");
        return fields_of(line);
    };
    TrcHeader header;
    if (!fields()[0].starts_with("PathFileType")) words.fail("does not begin with PathFileType", "give a TRC file");
    const std::vector<std::string> keys = fields(), values = fields();
    for (size_t i = 0; i < std::min(keys.size(), values.size()); ++i) {
        if (keys[i] == "DataRate") header.fps = number_in(values[i]).value_or(0);
        if (keys[i] == "Units") header.unit_m = metres_of(words, values[i]);
    }
    if (!(header.fps >= 1e-3 && header.fps <= 1e4)) words.fail("has no DataRate in frames a second");
    const std::vector<std::string> markers = fields();
    // A name stands above its x, and two empty fields follow; some programs leave these out.
    bool dense = false;
    for (size_t i = 2; i < markers.size(); ++i) dense |= (i - 2) % 3 != 0 && !markers[i].empty();
    std::vector<std::string> names;
    for (size_t i = 2; i < markers.size(); i += dense ? 1 : 3) names.push_back(markers[i]);
    header.joints = joints_of_markers(names);
    fields();
    return header;
}

Pose read_row(const Words& words, const TrcHeader& header, const std::vector<std::string>& fields) {
    Pose pose;
    for (size_t m = 0; m < header.joints.size(); ++m) {
        if (!header.joints[m] || 4 + 3 * m >= fields.size()) continue;
        JointSample& sample = pose[*header.joints[m]];
        bool known = true;
        for (int i = 0; i < 3; ++i) {
            const std::string& field = fields[2 + 3 * m + static_cast<size_t>(i)];
            const std::optional<double> value = number_in(field);
            if (!value && !field.empty() && lower_case(field) != "nan")
                words.fail(fmt::format("\"{}\" is no number", field.substr(0, 40)));
            known = known && value;
            sample.position[i] = value.value_or(0);
        }
        sample.confidence = known ? 1 : 0;
        sample.measured = known;
    }
    set_middle(pose, Joint::kPelvis, Joint::kRightHip, Joint::kLeftHip);
    set_middle(pose, Joint::kNeck, Joint::kRightShoulder, Joint::kLeftShoulder);
    return pose;
}

}  // namespace

FileMotion read_trc(const std::filesystem::path& file) {
    Words words(file);
    const TrcHeader header = read_header_lines(words);
    SkeletonClip clip;
    clip.fps = header.fps;
    std::string line;
    while (words.line(line)) {
        const std::vector<std::string> fields = fields_of(line);
        if (fields.size() < 3) continue;
        if (clip.frames.size() == kMaxSkeletonFrames)
            words.fail(fmt::format("has more than {} frames", kMaxSkeletonFrames));
        // Spaces do not tell where a marker is lacking.
        if (line.find('\t') == std::string::npos && fields.size() < 2 + 3 * header.joints.size())
            words.fail("has fewer numbers than its markers need",
                       "write a missing marker as nan, or part fields by tabs");
        clip.frames.push_back(read_row(words, header, fields));
    }
    if (clip.frames.empty()) words.fail("has no frames", "write it again");
    if (!(body_height(bone_lengths(clip)) > 0))
        throw InputError(file.string(), "line 4", "has no leg and trunk among its markers",
                         "name markers as Pose2Sim does: Hip, Neck, RHip, RKnee, RAnkle, RShoulder");
    if (is_of_pose2sim(file)) {
        turn_to_cameras(clip);
        clip.notes.push_back(
            Note(file.string() + ": of Pose2Sim, by its folder pose-3d: turned to how its cameras stand"));
    }
    return {std::move(clip), header.unit_m, false};
}

}  // namespace neuvv::motion
