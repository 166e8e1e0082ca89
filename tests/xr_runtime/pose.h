// Poses as OpenXR defines them. Where a is the pose of B in A, and b is the pose of C in B, `a * b` is the pose of C in
// A.
#pragma once

#include <algorithm>
#include <cmath>

#include "openxr_all.h"

namespace neuvv::xr_runtime {

inline constexpr XrPosef kIdentityPose = {{0, 0, 0, 1}, {0, 0, 0}};
inline constexpr XrSpaceLocationFlags kAllFlags =
    XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT |
    XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT | XR_SPACE_LOCATION_POSITION_TRACKED_BIT;

inline XrVector3f operator+(XrVector3f a, XrVector3f b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline XrVector3f operator-(XrVector3f a, XrVector3f b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline XrVector3f operator*(XrVector3f a, float s) {
    return {a.x * s, a.y * s, a.z * s};
}
inline XrVector3f cross(XrVector3f a, XrVector3f b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline XrQuaternionf operator*(XrQuaternionf a, XrQuaternionf b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
inline XrQuaternionf conjugate(XrQuaternionf q) {
    return {-q.x, -q.y, -q.z, q.w};
}
inline float dot(XrQuaternionf a, XrQuaternionf b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
inline XrQuaternionf normalised(XrQuaternionf q) {
    const float scale = 1 / std::sqrt(dot(q, q));
    return {q.x * scale, q.y * scale, q.z * scale, q.w * scale};
}

inline XrVector3f rotate(XrQuaternionf q, XrVector3f v) {
    const XrVector3f axis = {q.x, q.y, q.z};
    const XrVector3f twice = cross(axis, v) * 2;
    return v + twice * q.w + cross(axis, twice);
}

inline XrPosef operator*(const XrPosef& a, const XrPosef& b) {
    return {normalised(a.orientation * b.orientation), a.position + rotate(a.orientation, b.position)};
}
inline XrPosef inverse(const XrPosef& pose) {
    const XrQuaternionf back = conjugate(pose.orientation);
    return {back, rotate(back, pose.position) * -1};
}

// Yaw about +Y, then pitch about X, then roll about Z: R = Ry * Rx * Rz.
inline XrQuaternionf turned(float pitch_deg, float yaw_deg, float roll_deg) {
    const float half = 3.14159265358979f / 360;
    const XrQuaternionf x = {std::sin(pitch_deg * half), 0, 0, std::cos(pitch_deg * half)};
    const XrQuaternionf y = {0, std::sin(yaw_deg * half), 0, std::cos(yaw_deg * half)};
    const XrQuaternionf z = {0, 0, std::sin(roll_deg * half), std::cos(roll_deg * half)};
    return normalised(y * x * z);
}

inline XrPosef between(const XrPosef& a, const XrPosef& b, float t) {
    XrQuaternionf to = b.orientation;
    float cosine = dot(a.orientation, to);
    if (cosine < 0) {
        to = {-to.x, -to.y, -to.z, -to.w};
        cosine = -cosine;
    }
    float from_weight = 1 - t, to_weight = t;
    if (cosine < 0.9999f) {  // for smaller angles, the sines below lose all digits
        const float angle = std::acos(cosine);
        from_weight = std::sin((1 - t) * angle) / std::sin(angle);
        to_weight = std::sin(t * angle) / std::sin(angle);
    }
    const XrQuaternionf& from = a.orientation;
    return {normalised({from.x * from_weight + to.x * to_weight, from.y * from_weight + to.y * to_weight,
                        from.z * from_weight + to.z * to_weight, from.w * from_weight + to.w * to_weight}),
            a.position * (1 - t) + b.position * t};
}

// A unit quaternion, by the specification's definition: its length is within 1 % of 1.
inline bool is_valid(const XrPosef& pose) {
    const float length = std::sqrt(dot(pose.orientation, pose.orientation));
    const XrVector3f& p = pose.position;
    return std::abs(length - 1) <= 0.01f && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// The larger one of the distance in metres and the distance of the quaternions; q and -q count as the same rotation.
inline float difference(const XrPosef& a, const XrPosef& b) {
    const XrVector3f d = a.position - b.position;
    const float sign = dot(a.orientation, b.orientation) < 0 ? -1.0f : 1.0f;
    const XrQuaternionf &p = a.orientation, &q = b.orientation;
    const XrQuaternionf r = {p.x - sign * q.x, p.y - sign * q.y, p.z - sign * q.z, p.w - sign * q.w};
    return std::sqrt(std::max(d.x * d.x + d.y * d.y + d.z * d.z, dot(r, r)));
}

}  // namespace neuvv::xr_runtime
