// Reading TRC, a table of markers that OpenSim, Pose2Sim and motion capture systems write: five lines of head, then a
// line for each frame with its number, its time, and x, y, z of each marker.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "base/text.h"
#include "motion/skeleton_file.h"
#include "motion/words.h"

namespace neuvv::motion {

namespace {

constexpr double kMaxPlace = 1e7;

// "RBigToe", "right_big_toe" and "R.BigToe" → rightbigtoe.
std::string plain_marker(const std::string& name) {
    std::string plain;
    for (const char c : name)
        if (std::isalpha(static_cast<unsigned char>(c))) plain += c;
    const bool sided = plain.size() > 1 && std::isupper(static_cast<unsigned char>(plain[1]));
    if (sided && plain[0] == 'R') plain = "right" + plain.substr(1);
    if (sided && plain[0] == 'L') plain = "left" + plain.substr(1);
    return lower_case(plain);
}

std::optional<size_t> joint_of_marker(const std::string& name) {
    const std::string plain = plain_marker(name);
    if (plain == "hip" || plain == "hips" || plain == "midhip") return index_of(Joint::kPelvis);
    for (size_t j = 0; j < kJoints; ++j)
        if (plain == plain_marker(info_of(joint_at(j)).name)) return j;
    return std::nullopt;
}

double metres_of(const Words& words, const std::string& unit) {
    if (unit == "m") return 1;
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

struct TrcHead {
    double fps = 0, unit = 1;
    std::vector<std::optional<size_t>> joints;  // by marker
};

TrcHead read_head_lines(Words& words) {
    const auto fields = [&] {
        std::string line;
        if (!words.line(line)) words.fail("the file ends in its head", "write it again");
        return split(line, '\t');
    };
    TrcHead head;
    if (fields()[0] != "PathFileType") words.fail("does not begin with PathFileType", "give a TRC file");
    const std::vector<std::string> keys = fields(), values = fields();
    for (size_t i = 0; i < std::min(keys.size(), values.size()); ++i) {
        if (keys[i] == "DataRate") head.fps = number_in(values[i]).value_or(0);
        if (keys[i] == "Units") head.unit = metres_of(words, values[i]);
    }
    if (!(head.fps >= 1e-3 && head.fps <= 1e4)) words.fail("has no DataRate in frames a second");
    const std::vector<std::string> markers = fields();
    for (size_t i = 2; i < markers.size(); i += 3) head.joints.push_back(joint_of_marker(markers[i]));
    fields();
    return head;
}

Pose read_row(const Words& words, const TrcHead& head, const std::vector<std::string>& fields) {
    Pose pose;
    for (size_t m = 0; m < head.joints.size(); ++m) {
        if (!head.joints[m] || 4 + 3 * m >= fields.size()) continue;
        JointSample& sample = pose[*head.joints[m]];
        bool known = true;
        for (int i = 0; i < 3; ++i) {
            const std::string& field = fields[2 + 3 * m + static_cast<size_t>(i)];
            const std::optional<double> value = number_in(field);
            if (!value && !field.empty() && lower_case(field) != "nan")
                words.fail(fmt::format("\"{}\" is no number", field.substr(0, 40)));
            known = known && value;
            sample.position[i] = value.value_or(0) * head.unit;
        }
        sample.confidence = known ? 1 : 0;
        sample.measured = known;
    }
    return pose;
}

}  // namespace

SkeletonClip read_trc(const std::filesystem::path& file) {
    Words words(file);
    const TrcHead head = read_head_lines(words);
    SkeletonClip clip;
    clip.fps = head.fps;
    std::string line;
    while (words.line(line)) {
        const std::vector<std::string> fields = split(line, '\t');
        if (fields.size() < 3) continue;
        if (clip.frames.size() == kMaxSkeletonFrames)
            words.fail(fmt::format("has more than {} frames", kMaxSkeletonFrames));
        clip.frames.push_back(read_row(words, head, fields));
    }
    if (clip.frames.empty()) words.fail("has no frames", "write it again");
    if (!(body_height(bone_lengths(clip)) > 0))
        throw InputError(file.string(), "line 4", "has no leg and trunk among its markers",
                         "name markers as Pose2Sim does: Hip, Neck, RHip, RKnee, RAnkle");
    return clip;
}

}  // namespace neuvv::motion
