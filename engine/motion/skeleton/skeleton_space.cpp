#include "motion/skeleton/skeleton_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace neuvv::motion {

namespace {

constexpr double kUpright = 0.866;      // cos 30°: bodies that stand lean less
constexpr double kStandingShare = 0.5;  // of the frames
// +Y is up in most files, so that fewer frames in which the body stands along it are enough.
constexpr double kStandingShareOfY = 0.2;

constexpr double kYearOld_m = 0.85, kGiant_m = 2.5, kSmallestAdult_m = 1.2, kUsual_m = 1.7;
constexpr double kInch_m = 0.0254, kCmuUnit_m = 0.0254 / 0.45;
constexpr double kLeastBelievable_m = 0.4, kMostBelievable_m = 3;

glm::dvec3 direction_of(Axis axis) {
    const auto i = static_cast<int>(axis);
    glm::dvec3 direction(0);
    direction[i / 2] = i % 2 == 0 ? 1 : -1;
    return direction;
}

// The rotation that stands a body up.
glm::dmat3 upright_from(Axis axis) {
    switch (axis) {
        case Axis::kX:
            return {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
        case Axis::kMinusX:
            return {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
        case Axis::kY:
            return glm::dmat3(1);
        case Axis::kMinusY:
            return {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
        case Axis::kZ:
            return {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
        case Axis::kMinusZ:
            return {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    }
    return glm::dmat3(1);
}

// From the ankles that are known, else from the pelvis, to the neck; nothing where these are not known.
std::optional<glm::dvec3> body_axis(const Pose& pose) {
    const JointSample& neck = at(pose, Joint::kNeck);
    glm::dvec3 feet(0);
    double count = 0;
    for (const Joint joint : {Joint::kRightAnkle, Joint::kLeftAnkle})
        if (at(pose, joint).confidence > 0) feet += at(pose, joint).position, ++count;
    if (count == 0 && at(pose, Joint::kPelvis).confidence > 0) feet = at(pose, Joint::kPelvis).position, count = 1;
    if (count == 0 || !(neck.confidence > 0)) return std::nullopt;
    const glm::dvec3 along = neck.position - feet / count;
    return glm::length(along) > 0 ? std::optional(glm::normalize(along)) : std::nullopt;
}

void turn(SkeletonClip& clip, Axis up) {
    const glm::dmat3 rotation = upright_from(up);
    for (Pose& pose : clip.frames)
        for (JointSample& sample : pose) sample.position = rotation * sample.position;
}

std::string unit_name(double unit_m) {
    constexpr std::pair<double, const char*> kNames[] = {
        {1, "metres"}, {0.01, "centimetres"}, {0.001, "millimetres"}, {kInch_m, "inches"}, {kCmuUnit_m, "CMU's units"}};
    for (const auto& [unit, name] : kNames)
        if (unit == unit_m) return name;
    return fmt::format("{:.6g} m", unit_m);
}

// Turns the body upright: by the user's axis, else by the one along which it stands.
void stand_up(const MotionSpace& space, const std::string& file, SkeletonClip& clip) {
    if (space.up) return turn(clip, *space.up);
    const Axis standing = standing_axis(clip).value_or(Axis::kY);
    if (standing == Axis::kY) return;
    const char* const name = kAxisNames[static_cast<size_t>(standing)];
    // In no known program's files ±X or −Z is up: there the body lies.
    const bool is_up = !space.y_is_up && (standing == Axis::kZ || standing == Axis::kMinusY);
    if (is_up) turn(clip, standing);
    clip.notes.push_back(
        is_up ? Note(fmt::format("{}: the body stands along {}, which counts as up", file, name), Remedy::kUpIfLying)
              : Note(fmt::format("{}: the body lies along {}", file, name), {Remedy::kUpIfTrue, name}));
}

// How many metres a unit has.
double find_unit(const MotionSpace& space, const std::string& file, SkeletonClip& clip) {
    const double height = body_height(bone_lengths(clip));
    if (!(height > 0) && !(space.unit_m > 0 && space.height_m == 0))
        throw InputError(file, "", "has a body without height", Remedy::kGiveUnit);
    if (space.height_m > 0) return space.height_m / height;
    const double unit = space.unit_m > 0 ? space.unit_m : likely_unit(height);
    const double height_m = height * unit;
    const bool believable = height_m > kLeastBelievable_m && height_m < kMostBelievable_m;
    const bool doubtful = space.unit_m == 0 && (unit == kInch_m || unit == kCmuUnit_m);
    if (height > 0 && (doubtful || !believable))
        clip.notes.push_back(
            Note(fmt::format("{}: its lengths count as {}, the body as {:.2f} m", file, unit_name(unit), height_m),
                 Remedy::kUnitIfWrong));
    return unit;
}

}  // namespace

std::optional<Axis> standing_axis(const SkeletonClip& clip) {
    std::array<double, kAxisNames.size()> frames{};
    double known = 0;
    for (const Pose& pose : clip.frames) {
        const std::optional<glm::dvec3> along = body_axis(pose);
        if (!along) continue;
        ++known;
        for (size_t i = 0; i < frames.size(); ++i)
            frames[i] += glm::dot(*along, direction_of(static_cast<Axis>(i))) > kUpright;
    }
    if (known == 0) return std::nullopt;
    if (frames[static_cast<size_t>(Axis::kY)] >= kStandingShareOfY * known) return Axis::kY;
    const auto most = std::ranges::max_element(frames);
    return *most >= kStandingShare * known ? std::optional(static_cast<Axis>(most - frames.begin())) : std::nullopt;
}

double likely_unit(double height) {
    for (const double unit : {1.0, 0.01, 0.001})
        if (height * unit >= kYearOld_m && height * unit <= kGiant_m) return unit;
    for (const double unit : {kInch_m, kCmuUnit_m})
        if (height * unit >= kSmallestAdult_m && height * unit <= kGiant_m) return unit;
    const auto off = [&](double unit) { return std::abs(std::log(height * unit / kUsual_m)); };
    return std::min({1.0, 0.01, 0.001}, [&](double a, double b) { return off(a) < off(b); });
}

void bring_to_metres(const MotionSpace& space, const std::string& file, SkeletonClip& clip) {
    stand_up(space, file, clip);
    const double unit = find_unit(space, file, clip);
    for (Pose& pose : clip.frames)
        for (JointSample& sample : pose) sample.position *= unit;
    if (faces_backwards(clip))
        clip.notes.push_back(file + ": knees, feet or nose point backwards: left and right are probably exchanged");
}

}  // namespace neuvv::motion
