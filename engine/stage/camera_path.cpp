#include "stage/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace neuvv::stage {

namespace {

constexpr double kMaxVelocity = 3;  // of the slower segment's: monotone keys stay monotone
// Horizontal length of the direction of view (1 for a level one) where roll begins to count, and where it counts fully.
const double kRollFrom = std::sin(5 * std::numbers::pi / 180), kRollFull = std::sin(15 * std::numbers::pi / 180);

// Turns of the roll from key to key up to which it is interpolated, and beyond which it is not.
constexpr double kRollTurn = 45 * std::numbers::pi / 180, kMaxRollTurn = 90 * std::numbers::pi / 180;

// A time on a path: between two keys, with the one before and the one after them.
struct Place {
    std::array<const CameraPathKey*, 4> keys{};  // null where an open path has ended
    std::array<double, 3> seconds{};             // between them
    double u = 0;                                // 0 at keys[1] … 1 at keys[2]
};

Place find_place(const CameraPath& path, double time_s) {
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
    Place place;
    for (ptrdiff_t k = 0; k < 4; ++k) place.keys[static_cast<size_t>(k)] = key_at(first - 1 + k);
    for (size_t k = 0; k < 3; ++k) {
        const ptrdiff_t i = first - 1 + static_cast<ptrdiff_t>(k);
        if (place.keys[k] && place.keys[k + 1])
            place.seconds[k] = place.keys[k + 1]->time_s - place.keys[k]->time_s +
                               static_cast<double>(laps(i + 1) - laps(i)) * path.duration_s;
    }
    if (place.keys[2]) place.u = std::clamp((time_s - place.keys[1]->time_s) / place.seconds[1], 0.0, 1.0);
    return place;
}

double size_of(double value) {
    return std::abs(value);
}
double size_of(const glm::dvec3& value) {
    return glm::length(value);
}

// The velocity at a key between two segments of these mean velocities and lengths: that of the parabola through the
// three keys, no faster than kMaxVelocity times the slower.
template <typename V>
V velocity_between(const V& before, double seconds_before, const V& after, double seconds_after) {
    const V velocity = (seconds_after * before + seconds_before * after) / (seconds_before + seconds_after);
    const double most = kMaxVelocity * std::min(size_of(before), size_of(after)), speed = size_of(velocity);
    return speed > most ? velocity * (most / speed) : velocity;
}

template <typename V>
struct Ends {
    V first, second;
};

// Velocities at both ends of the middle segment, from the mean velocities of the three.
template <typename V>
Ends<V> end_velocities(const Place& place, const std::array<V, 3>& mean) {
    const bool has_before = place.keys[0], has_after = place.keys[3];
    const auto& t = place.seconds;
    Ends<V> ends{mean[1], mean[1]};
    if (has_before) ends.first = velocity_between(mean[0], t[0], mean[1], t[1]);
    if (has_after) ends.second = velocity_between(mean[1], t[1], mean[2], t[2]);
    // An end of the path: no acceleration there.
    if (!has_before && has_after) ends.first = 1.5 * mean[1] - 0.5 * ends.second;
    if (!has_after && has_before) ends.second = 1.5 * mean[1] - 0.5 * ends.first;
    return ends;
}

template <typename V>
V hermite(const V& from, const V& to, const Ends<V>& velocity, double seconds, double u) {
    const double v = 1 - u;
    return from + (u * u * (3 - 2 * u)) * (to - from) + seconds * u * v * (v * velocity.first - u * velocity.second);
}

// Whether both keys of this one of the three segments are there.
bool has_segment(const Place& place, size_t segment) {
    return place.keys[segment] && place.keys[segment + 1];
}

glm::dvec3 position_at(const Place& place, Interpolation interpolation) {
    const CameraPathKey &a = *place.keys[1], &b = *place.keys[2];
    if (interpolation == Interpolation::kLinear) return glm::mix(a.position, b.position, place.u);
    std::array<glm::dvec3, 3> mean{};
    for (size_t k = 0; k < 3; ++k)
        if (has_segment(place, k)) mean[k] = (place.keys[k + 1]->position - place.keys[k]->position) / place.seconds[k];
    return hermite(a.position, b.position, end_velocities(place, mean), place.seconds[1], place.u);
}

using KeyNumbers = std::array<double, 4>;  // by key of a place; 0 where there is none

template <typename NumberOf>
KeyNumbers numbers_of(const Place& place, const NumberOf& number_of) {
    KeyNumbers numbers{};
    for (size_t k = 0; k < 4; ++k)
        if (place.keys[k]) numbers[k] = number_of(*place.keys[k]);
    return numbers;
}

// Never beyond the numbers of the keys beside it.
double number_at(const Place& place, Interpolation interpolation, const KeyNumbers& numbers) {
    if (interpolation == Interpolation::kLinear) return glm::mix(numbers[1], numbers[2], place.u);
    std::array<double, 3> mean{};
    for (size_t k = 0; k < 3; ++k)
        if (has_segment(place, k)) mean[k] = (numbers[k + 1] - numbers[k]) / place.seconds[k];
    Ends<double> ends = end_velocities(place, mean);
    if (place.keys[0] && mean[0] * mean[1] <= 0) ends.first = 0;
    if (place.keys[3] && mean[1] * mean[2] <= 0) ends.second = 0;
    return hermite(numbers[1], numbers[2], ends, place.seconds[1], place.u);
}

// Half the rotation vector of the shorter way, and back.
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

// Half rotation vectors a second are in the camera's own axes: a turn between two keys is the same seen from either.
glm::dquat turned_at(const Place& place, Interpolation interpolation) {
    const auto turn = [&](size_t k) {
        return log_of(glm::conjugate(place.keys[k]->world_from_camera) * place.keys[k + 1]->world_from_camera);
    };
    const glm::dquat& from = place.keys[1]->world_from_camera;
    const double u = place.u, seconds = place.seconds[1];
    if (interpolation == Interpolation::kLinear) return from * exp_of(u * turn(1));
    std::array<glm::dvec3, 3> mean{};
    for (size_t k = 0; k < 3; ++k)
        if (has_segment(place, k)) mean[k] = turn(k) / place.seconds[k];
    const Ends<glm::dvec3> velocity = end_velocities(place, mean);
    const glm::dvec3 first = velocity.first * (seconds / 3), last = velocity.second * (seconds / 3);
    const glm::dvec3 middle =
        log_of(exp_of(-first) * glm::conjugate(from) * place.keys[2]->world_from_camera * exp_of(-last));
    const double v = 1 - u;  // the cumulative Bernstein polynomials of degree three
    return from * exp_of((1 - v * v * v) * first) * exp_of((u * u * (3 - 2 * u)) * middle) * exp_of((u * u * u) * last);
}

// How much the roll of a view counts: 0 near the vertical.
double roll_weight(const glm::dquat& world_from_camera) {
    const glm::dvec3 view = world_from_camera * glm::dvec3(0, 0, -1);
    return glm::smoothstep(kRollFrom, kRollFull, std::hypot(view.x, view.z));
}

// Rolls of the keys, each counted on from the one before it the shorter way; 0 where they do not count at all.
KeyNumbers rolls_of(const Place& place) {
    KeyNumbers rolls = numbers_of(place, [](const CameraPathKey& key) {
        return roll_weight(key.world_from_camera) > 0 ? roll_of(key.world_from_camera) : 0;
    });
    const auto count_on = [&](size_t from, size_t to) {
        rolls[to] = rolls[from] + std::remainder(rolls[to] - rolls[from], 2 * std::numbers::pi);
    };
    count_on(1, 0);
    count_on(1, 2);
    count_on(2, 3);
    return rolls;
}

// How much the roll of a key counts: not at all where a segment beside it turns it by much, as going over the pole
// does.
double key_weight(const Place& place, const KeyNumbers& rolls, size_t k) {
    double most = 0;
    for (const size_t beside : {k - 1, k + 1})
        if (place.keys[beside]) most = std::max(most, std::abs(rolls[beside] - rolls[k]));
    return roll_weight(place.keys[k]->world_from_camera) * (1 - glm::smoothstep(kRollTurn, kMaxRollTurn, most));
}

glm::dquat orientation_at(const Place& place, Interpolation interpolation) {
    const glm::dquat turned = turned_at(place, interpolation);
    const KeyNumbers rolls = rolls_of(place);
    const double weight =
        glm::mix(key_weight(place, rolls, 1), key_weight(place, rolls, 2), glm::smoothstep(0.0, 1.0, place.u));
    const double off = std::remainder(number_at(place, interpolation, rolls) - roll_of(turned), 2 * std::numbers::pi);
    return glm::normalize(turned * exp_of(glm::dvec3(0, 0, 0.5 * weight * roll_weight(turned) * off)));
}

// Of an image with this width for one of its height.
double vertical_angle(const CameraPathKey& key, double aspect) {
    return key.angle_x ? 2 * std::atan(std::tan(0.5 * *key.angle_x) * key.stretch / aspect) : key.angle_y;
}

CameraPathKey key_between(const Place& place, Interpolation interpolation, double aspect) {
    const auto number = [&](const auto& number_of) {
        return number_at(place, interpolation, numbers_of(place, number_of));
    };
    CameraPathKey key;
    key.position = position_at(place, interpolation);
    key.world_from_camera = orientation_at(place, interpolation);
    key.angle_y = number([&](const CameraPathKey& k) { return vertical_angle(k, aspect); });
    key.stretch = number([](const CameraPathKey& k) { return k.stretch; });
    key.shift = {number([](const CameraPathKey& k) { return k.shift.x; }),
                 number([](const CameraPathKey& k) { return k.shift.y; })};
    return key;
}

// Nothing to interpolate: on a key, after the last, or cut.
bool rests(const Place& place, Interpolation interpolation) {
    return interpolation == Interpolation::kCut || !place.keys[2] || place.u == 0;
}

}  // namespace

double roll_of(const glm::dquat& world_from_camera) {
    const glm::dvec3 view = world_from_camera * glm::dvec3(0, 0, -1), right = world_from_camera * glm::dvec3(1, 0, 0);
    const glm::dvec3 level = glm::cross(view, glm::dvec3(0, 1, 0));
    if (glm::length(level) == 0) return 0;
    return std::atan2(glm::dot(right, glm::cross(level, view)), glm::dot(right, level));
}

Camera camera_at(const CameraPath& path, double time_s, uint32_t width, uint32_t height) {
    const Place place = find_place(path, time_s);
    const double aspect = static_cast<double>(width) / height;
    CameraPathKey key = *place.keys[1];
    if (rests(place, path.interpolation))
        key.angle_y = vertical_angle(key, aspect);
    else
        key = key_between(place, path.interpolation, aspect);
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

std::optional<double> clip_time_at(const CameraPath& path, double time_s) {
    const Place place = find_place(path, time_s);
    if (rests(place, path.interpolation)) return place.keys[1]->clip_time;
    if (!place.keys[1]->clip_time || !place.keys[2]->clip_time) return std::nullopt;
    Place timed = place;
    for (const size_t outer : {0, 3})
        if (timed.keys[outer] && !timed.keys[outer]->clip_time) timed.keys[outer] = nullptr;
    const KeyNumbers times = numbers_of(timed, [](const CameraPathKey& key) { return *key.clip_time; });
    return number_at(timed, path.interpolation, times);
}

}  // namespace neuvv::stage
