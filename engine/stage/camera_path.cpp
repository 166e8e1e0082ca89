#include "stage/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/error.h"

namespace neuvv::stage {

namespace {

// Limits the velocity at a key to so many times that of the slower segment beside it, which keeps curves monotone.
constexpr double kMaxVelocity = 3;
// The horizontal length of the unit direction of view (1 for a level one) from which roll has a weight, and from which
// that weight is 1.
const double kRollFrom = std::sin(5 * std::numbers::pi / 180), kRollFull = std::sin(15 * std::numbers::pi / 180);

// Roll is interpolated fully where it turns by at most kRollTurn from key to key, and not at all from kMaxRollTurn on.
constexpr double kRollTurn = 45 * std::numbers::pi / 180, kMaxRollTurn = 90 * std::numbers::pi / 180;

// The four keys around a time of a path: the time lies between keys[1] and keys[2].
struct KeyWindow {
    std::array<const CameraPathKey*, 4> keys{};  // null before the first and after the last key of an open path
    std::array<double, 3> seconds{};             // seconds[k]: from keys[k] to keys[k + 1]
    double u = 0;                                // the time, from 0 at keys[1] to 1 at keys[2]
};

KeyWindow find_window(const CameraPath& path, double time_s) {
    const std::vector<CameraPathKey>& keys = path.keys;
    const auto count = static_cast<ptrdiff_t>(keys.size());
    assert(count > 0 && "a camera path has a key");
    const bool cyclic = path.cyclic && count > 1;
    const double begin = keys[0].time_s;
    if (cyclic && (time_s < begin || time_s >= begin + path.duration_s)) {
        time_s = begin + std::fmod(time_s - begin, path.duration_s);
        if (time_s < begin) time_s += path.duration_s;
    }
    const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                        [](double t, const CameraPathKey& key) { return t < key.time_s; });
    const ptrdiff_t first = std::max<ptrdiff_t>(after - keys.begin() - 1, 0);
    const auto laps = [&](ptrdiff_t i) { return i < 0 ? -1 : i / count; };  // i ≥ −count
    const auto key_at = [&](ptrdiff_t i) -> const CameraPathKey* {
        return cyclic ? &keys[static_cast<size_t>((i + count) % count)]
                      : (i < 0 || i >= count ? nullptr : &keys[static_cast<size_t>(i)]);
    };
    KeyWindow window;
    for (ptrdiff_t k = 0; k < 4; ++k) window.keys[static_cast<size_t>(k)] = key_at(first - 1 + k);
    for (size_t k = 0; k < 3; ++k) {
        const ptrdiff_t i = first - 1 + static_cast<ptrdiff_t>(k);
        if (window.keys[k] && window.keys[k + 1])
            window.seconds[k] = window.keys[k + 1]->time_s - window.keys[k]->time_s +
                                static_cast<double>(laps(i + 1) - laps(i)) * path.duration_s;
    }
    if (window.keys[2]) window.u = std::clamp((time_s - window.keys[1]->time_s) / window.seconds[1], 0.0, 1.0);
    return window;
}

double size_of(double value) {
    return std::abs(value);
}
double size_of(const glm::dvec3& value) {
    return glm::length(value);
}

// The velocity at a key between two segments, of which mean velocities and durations are given: that of the parabola
// through the three keys, at most kMaxVelocity times the mean velocity of the slower segment.
template <typename V>
V velocity_between(const V& before, double seconds_before, const V& after, double seconds_after) {
    const V velocity = (seconds_after * before + seconds_before * after) / (seconds_before + seconds_after);
    const double max_speed = kMaxVelocity * std::min(size_of(before), size_of(after)), speed = size_of(velocity);
    return speed > max_speed ? velocity * (max_speed / speed) : velocity;
}

template <typename V>
struct Ends {
    V first, second;
};

// Velocities at both ends of the middle segment, from the mean velocities of the three segments.
template <typename V>
Ends<V> end_velocities(const KeyWindow& window, const std::array<V, 3>& mean) {
    const bool has_before = window.keys[0], has_after = window.keys[3];
    const auto& t = window.seconds;
    Ends<V> ends{mean[1], mean[1]};
    if (has_before) ends.first = velocity_between(mean[0], t[0], mean[1], t[1]);
    if (has_after) ends.second = velocity_between(mean[1], t[1], mean[2], t[2]);
    // At an end of the path the acceleration is 0.
    if (!has_before && has_after) ends.first = 1.5 * mean[1] - 0.5 * ends.second;
    if (!has_after && has_before) ends.second = 1.5 * mean[1] - 0.5 * ends.first;
    return ends;
}

template <typename V>
V hermite(const V& from, const V& to, const Ends<V>& velocity, double seconds, double u) {
    const double v = 1 - u;
    return from + (u * u * (3 - 2 * u)) * (to - from) + seconds * u * v * (v * velocity.first - u * velocity.second);
}

// Whether both keys of a segment (0 to 2) exist.
bool has_segment(const KeyWindow& window, size_t segment) {
    return window.keys[segment] && window.keys[segment + 1];
}

glm::dvec3 position_at(const KeyWindow& window, Interpolation interpolation) {
    const CameraPathKey &a = *window.keys[1], &b = *window.keys[2];
    if (interpolation == Interpolation::kLinear) return glm::mix(a.position, b.position, window.u);
    std::array<glm::dvec3, 3> mean{};
    for (size_t k = 0; k < 3; ++k)
        if (has_segment(window, k))
            mean[k] = (window.keys[k + 1]->position - window.keys[k]->position) / window.seconds[k];
    return hermite(a.position, b.position, end_velocities(window, mean), window.seconds[1], window.u);
}

using KeyNumbers = std::array<double, 4>;  // a number of each key of a window; 0 where there is no key

template <typename NumberOf>
KeyNumbers numbers_of(const KeyWindow& window, const NumberOf& number_of) {
    KeyNumbers numbers{};
    for (size_t k = 0; k < 4; ++k)
        if (window.keys[k]) numbers[k] = number_of(*window.keys[k]);
    return numbers;
}

// The interpolated number. It never lies outside the numbers of keys[1] and keys[2].
double number_at(const KeyWindow& window, Interpolation interpolation, const KeyNumbers& numbers) {
    if (interpolation == Interpolation::kLinear) return glm::mix(numbers[1], numbers[2], window.u);
    std::array<double, 3> mean{};
    for (size_t k = 0; k < 3; ++k)
        if (has_segment(window, k)) mean[k] = (numbers[k + 1] - numbers[k]) / window.seconds[k];
    Ends<double> ends = end_velocities(window, mean);
    if (window.keys[0] && mean[0] * mean[1] <= 0) ends.first = 0;
    if (window.keys[3] && mean[1] * mean[2] <= 0) ends.second = 0;
    return hermite(numbers[1], numbers[2], ends, window.seconds[1], window.u);
}

// Half of the rotation vector of a unit quaternion, for the turn of at most π, and the inverse.
glm::dvec3 log_of(glm::dquat q) {
    if (q.w < 0) q = -q;
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = glm::length(v);
    return sine > 0 ? v * (std::atan2(sine, q.w) / sine) : v;
}
glm::dquat exp_of(const glm::dvec3& half) {
    const double angle = glm::length(half);
    const glm::dvec3 v = angle > 0 ? half * (std::sin(angle) / angle) : half;
    return {std::cos(angle), v.x, v.y, v.z};
}

// Velocities are half rotation vectors per second in the camera's own axes: a turn between two keys has the same axis
// in the axes of both.
glm::dquat turned_at(const KeyWindow& window, Interpolation interpolation) {
    const auto turn = [&](size_t k) {
        return log_of(glm::conjugate(window.keys[k]->world_from_camera) * window.keys[k + 1]->world_from_camera);
    };
    const glm::dquat& from = window.keys[1]->world_from_camera;
    const double u = window.u, seconds = window.seconds[1];
    if (interpolation == Interpolation::kLinear) return from * exp_of(u * turn(1));
    std::array<glm::dvec3, 3> mean{};
    for (size_t k = 0; k < 3; ++k)
        if (has_segment(window, k)) mean[k] = turn(k) / window.seconds[k];
    const Ends<glm::dvec3> velocity = end_velocities(window, mean);
    const glm::dvec3 first = velocity.first * (seconds / 3), last = velocity.second * (seconds / 3);
    const glm::dvec3 centre =
        log_of(exp_of(-first) * glm::conjugate(from) * window.keys[2]->world_from_camera * exp_of(-last));
    const double v = 1 - u;  // the cumulative Bernstein polynomials of degree three
    return from * exp_of((1 - v * v * v) * first) * exp_of((u * u * (3 - 2 * u)) * centre) * exp_of((u * u * u) * last);
}

// The weight of a view's roll, 0 to 1: 0 near the vertical.
double roll_weight(const glm::dquat& world_from_camera) {
    const glm::dvec3 view = world_from_camera * glm::dvec3(0, 0, -1);
    return glm::smoothstep(kRollFrom, kRollFull, std::hypot(view.x, view.z));
}

// The rolls of the keys in radians, 0 where their weight is 0, each shifted by multiples of 2π so that it is at most π
// from its neighbour's.
KeyNumbers rolls_of(const KeyWindow& window) {
    KeyNumbers rolls = numbers_of(window, [](const CameraPathKey& key) {
        return roll_weight(key.world_from_camera) > 0 ? roll_of(key.world_from_camera) : 0;
    });
    const auto unwrap = [&](size_t from, size_t to) {
        rolls[to] = rolls[from] + std::remainder(rolls[to] - rolls[from], 2 * std::numbers::pi);
    };
    unwrap(1, 0);
    unwrap(1, 2);
    unwrap(2, 3);
    return rolls;
}

// The weight of a key's roll, 0 to 1: it fades where the roll turns much in a segment beside the key, as it does when
// the view passes over the pole.
double key_weight(const KeyWindow& window, const KeyNumbers& rolls, size_t k) {
    double max_turn = 0;
    for (const size_t beside : {k - 1, k + 1})
        if (window.keys[beside]) max_turn = std::max(max_turn, std::abs(rolls[beside] - rolls[k]));
    return roll_weight(window.keys[k]->world_from_camera) * (1 - glm::smoothstep(kRollTurn, kMaxRollTurn, max_turn));
}

glm::dquat orientation_at(const KeyWindow& window, Interpolation interpolation) {
    const glm::dquat turned = turned_at(window, interpolation);
    const KeyNumbers rolls = rolls_of(window);
    const double weight =
        glm::mix(key_weight(window, rolls, 1), key_weight(window, rolls, 2), glm::smoothstep(0.0, 1.0, window.u));
    const double off = std::remainder(number_at(window, interpolation, rolls) - roll_of(turned), 2 * std::numbers::pi);
    return glm::normalize(turned * exp_of(glm::dvec3(0, 0, 0.5 * weight * roll_weight(turned) * off)));
}

// The key's vertical angle of view, radians, in an image whose width is `aspect` times its height.
double vertical_angle(const CameraPathKey& key, double aspect) {
    return key.angle_x ? 2 * std::atan(std::tan(0.5 * *key.angle_x) * key.stretch / aspect) : key.angle_y;
}

CameraPathKey key_between(const KeyWindow& window, Interpolation interpolation, double aspect) {
    const auto number = [&](const auto& number_of) {
        return number_at(window, interpolation, numbers_of(window, number_of));
    };
    CameraPathKey key;
    key.position = position_at(window, interpolation);
    key.world_from_camera = orientation_at(window, interpolation);
    key.angle_y = number([&](const CameraPathKey& k) { return vertical_angle(k, aspect); });
    key.stretch = number([](const CameraPathKey& k) { return k.stretch; });
    key.shift = {number([](const CameraPathKey& k) { return k.shift.x; }),
                 number([](const CameraPathKey& k) { return k.shift.y; })};
    return key;
}

// Whether the camera is that of keys[1]: at the key itself, after the last key, or where the path cuts from key to key.
bool rests(const KeyWindow& window, Interpolation interpolation) {
    return interpolation == Interpolation::kCut || !window.keys[2] || window.u == 0;
}

}  // namespace

double roll_of(const glm::dquat& world_from_camera) {
    const glm::dvec3 view = world_from_camera * glm::dvec3(0, 0, -1), right = world_from_camera * glm::dvec3(1, 0, 0);
    const glm::dvec3 level = glm::cross(view, glm::dvec3(0, 1, 0));
    if (glm::length(level) == 0) return 0;
    return std::atan2(glm::dot(right, glm::cross(level, view)), glm::dot(right, level));
}

Camera camera_at(const CameraPath& path, double time_s, uint32_t width, uint32_t height) {
    const KeyWindow window = find_window(path, time_s);
    const double aspect = static_cast<double>(width) / height;
    CameraPathKey key = *window.keys[1];
    if (rests(window, path.interpolation))
        key.angle_y = vertical_angle(key, aspect);
    else
        key = key_between(window, path.interpolation, aspect);
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fy = 0.5 * height / std::tan(0.5 * key.angle_y);
    camera.fx = key.stretch * camera.fy;
    camera.cx = 0.5 * width + key.shift.x * height;
    camera.cy = 0.5 * height + key.shift.y * height;
    camera.world_from_camera = glm::dmat4(glm::mat3_cast(key.world_from_camera));
    camera.world_from_camera[3] = glm::dvec4(key.position, 1);
    return camera;
}

CameraPathKey key_of(const Camera& camera, double time_s) {
    CameraPathKey key;
    key.time_s = time_s;
    key.position = glm::dvec3(camera.world_from_camera[3]);
    key.world_from_camera = glm::normalize(glm::quat_cast(glm::dmat3(camera.world_from_camera)));
    key.angle_y = 2 * std::atan(0.5 * camera.height / camera.fy);
    key.stretch = camera.fx / camera.fy;
    key.shift = glm::dvec2(camera.cx - 0.5 * camera.width, camera.cy - 0.5 * camera.height) / (1.0 * camera.height);
    return key;
}

CameraPath by_images(const CameraPath& path, double fps, uint32_t width, uint32_t height) {
    constexpr double kRounding = 1e-6;  // of an image: a last key at i / fps is image i
    double count = 1;
    if (path.keys.size() > 1)
        count = path.cyclic ? std::ceil(path.duration_s * fps - kRounding)
                            : std::floor(path.duration_s * fps + kRounding) + 1;
    if (!(count <= static_cast<double>(kMaxPathKeys)))
        throw InputError("camera path", fmt::format("{:.6g} s at {:.6g} fps", path.duration_s, fps),
                         fmt::format("has more than {} images", kMaxPathKeys), "choose fewer images a second");
    CameraPath images;
    images.interpolation = Interpolation::kLinear;
    images.cyclic = path.cyclic && count > 1;
    images.width = width;
    images.height = height;
    images.fps = fps;
    for (double i = 0; i < count; ++i) {
        images.keys.push_back(key_of(camera_at(path, i / fps, width, height), i / fps));
        images.keys.back().clip_time = clip_time_at(path, i / fps);
    }
    images.duration_s = images.cyclic ? path.duration_s : images.keys.back().time_s;
    return images;
}

std::optional<double> clip_time_at(const CameraPath& path, double time_s) {
    const KeyWindow window = find_window(path, time_s);
    if (rests(window, path.interpolation)) return window.keys[1]->clip_time;
    if (!window.keys[1]->clip_time || !window.keys[2]->clip_time) return std::nullopt;
    KeyWindow timed = window;
    for (const size_t outer : {0, 3})
        if (timed.keys[outer] && !timed.keys[outer]->clip_time) timed.keys[outer] = nullptr;
    const KeyNumbers times = numbers_of(timed, [](const CameraPathKey& key) { return *key.clip_time; });
    return number_at(timed, path.interpolation, times);
}

}  // namespace neuvv::stage
