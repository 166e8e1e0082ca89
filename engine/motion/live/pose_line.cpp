#include "motion/live/pose_line.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/formats/json.h"

namespace neuvv::motion {

namespace {

constexpr double kMostSeconds = 1e9, kFarthest_m = 1e4;
constexpr double kAbsent_s = 2;  // after which another person may go on

size_t joint_of_name(const std::string& name, const JsonNode& node) {
    for (size_t j = 0; j < kJoints; ++j)
        if (name == info_of(joint_at(j)).name) return j;
    node.fail(fmt::format("\"{}\" is no joint", name.substr(0, 40)), "use the names of engine/motion/README.md");
}

std::string read_person_name(const JsonNode& node) {
    if (node.value.is_number_integer()) return node.value.dump();
    return json_string(node).substr(0, 40);
}

JointSample read_joint(const JsonNode& node) {
    if (!node.value.is_array() || node.value.size() < 3 || node.value.size() > 4)
        node.fail("is not [x, y, z] or [x, y, z, confidence]");
    JointSample sample;
    for (int i = 0; i < 3; ++i)
        sample.position[i] = json_number(node[static_cast<size_t>(i)], -kFarthest_m, kFarthest_m, "a place in metres");
    sample.confidence = node.value.size() == 4 ? json_number(node[3], 0, 1, "a confidence") : 1;
    sample.measured = sample.confidence > 0;
    return sample;
}

}  // namespace

TimedPose read_pose_line(const std::string& line, const std::string& stream) {
    if (line.size() > kLongestPoseLine) throw InputError(stream, "", "has a line of more than 64 KiB");
    const nlohmann::json document = nlohmann::json::parse(line, nullptr, false);
    if (!document.is_object())
        throw InputError(stream, "", "has a line that is no JSON object", "write one pose a line");
    const JsonNode root{document, stream, ""};
    TimedPose result;
    result.time_s = json_number(root["time"], -kMostSeconds, kMostSeconds, "a time in seconds");
    const JsonNode joints = root["joints"];
    if (!joints.value.is_object()) joints.fail_type("an object");
    for (const auto& [name, value] : joints.value.items())
        result.pose[joint_of_name(name, joints)] = read_joint(joints[name.c_str()]);
    if (root.has("person")) result.person = read_person_name(root["person"]);
    if (root.has("estimated")) {
        const JsonNode estimated = root["estimated"];
        if (!estimated.value.is_array()) estimated.fail_type("a list");
        for (size_t i = 0; i < estimated.value.size(); ++i)
            result.pose[joint_of_name(json_string(estimated[i]), estimated)].measured = false;
    }
    return result;
}

std::string pose_line(const TimedPose& timed) {
    nlohmann::ordered_json joints = nlohmann::ordered_json::object(), estimated = nlohmann::ordered_json::array();
    for (size_t j = 0; j < kJoints; ++j) {
        const JointSample& sample = timed.pose[j];
        if (!(sample.confidence > 0)) continue;
        const glm::dvec3& p = sample.position;
        joints[info_of(joint_at(j)).name] = {p.x, p.y, p.z, sample.confidence};
        if (!sample.measured) estimated.push_back(info_of(joint_at(j)).name);
    }
    nlohmann::ordered_json json = {{"time", timed.time_s}, {"joints", joints}};
    if (!estimated.empty()) json["estimated"] = estimated;
    return json.dump();
}

void FirstPerson::expect(const TimedPose& pose, const std::string& stream) {
    const auto name = [](const std::string& person) {
        return person.empty() ? "a person without a name" : fmt::format("\"{}\"", person);
    };
    if (first_ && *first_ != pose.person && std::abs(pose.time_s - seen_s_) <= kAbsent_s)
        throw InputError(stream, "person",
                         fmt::format("is {}, and {}, who came first, is followed", name(pose.person), name(*first_)));
    first_ = pose.person;
    seen_s_ = pose.time_s;
}

}  // namespace neuvv::motion
