// The eye of the viewer: its camera, and how mouse, keys and touchpad move it.
//
// An Eye looks at a pivot. World: +Y up, metres. Angles in radians. Each function takes an eye and returns the moved
// eye; members that its comment does not name keep their values. Pixels: x to the right, y down. `height` is the height
// of the image in pixels: a drag over the same part of it turns by the same angle on every screen. Distances and angles
// stay within the limits below.
//
//   left drag              orbited    the scene follows the pointer, about the pivot
//   middle drag            panned     the grabbed point of the pivot's plane follows the pointer
//   right drag             turned     the eye stays and looks around
//   W A S D Q E            flown
//   wheel                  dollied    towards the pivot
//   touchpad, two fingers  scrolled   orbits; with Shift pans; with Ctrl dollies (as in Blender)
#pragma once

#include <optional>

#include "stage/camera.h"

namespace neuvv::viewer {

struct Eye {
    glm::dvec3 pivot{0};
    double yaw = 0;        // about +Y: 0 looks along −Z, π/2 along −X
    double pitch = 0;      // −π/2 down … π/2 up
    double roll = 0;       // about the axis of view, after the others; only looking_through sets it
    double distance = 3;   // from the pivot, metres
    double angle_y = 0.6;  // the whole vertical angle of view
    bool operator==(const Eye&) const = default;
};

constexpr double kMinEyeDistance_m = 1e-2, kMaxEyeDistance_m = 1e5;
constexpr double kMinEyeAngle = 0.01, kMaxEyeAngle = 2.6;

glm::dmat4 world_from_eye(const Eye& eye);  // as Camera::world_from_camera
// A camera with square pixels and the principal point in the centre of the image.
stage::Camera camera_of(const Eye& eye, uint32_t width, uint32_t height);

// Turns yaw and pitch about the pivot; a drag over the height of the image is half a revolution. Pitch stops at the
// poles.
Eye orbited(const Eye& eye, glm::dvec2 moved_px, double height);
// Turns by the same angles about the position of the eye, which looks where the pointer goes, as in games.
Eye turned(const Eye& eye, glm::dvec2 moved_px, double height);
// Moves the pivot parallel to the image. A point at the pivot's depth stays exactly under the pointer.
Eye panned(const Eye& eye, glm::dvec2 moved_px, double height);
// Each notch reduces the distance from the pivot by a tenth; a negative one reverses that. With `towards`, a point of
// the world, that point stays where it is in the image, and the pivot moves, too.
Eye dollied(const Eye& eye, double notches, const std::optional<glm::dvec3>& towards = {});

// Scrolling as GLFW reports it. Whole numbers in y alone come from a wheel, which dollies whatever keys are down: a
// notch up is a notch closer. Anything else comes from two fingers on a touchpad.
struct Scroll {
    glm::dvec2 offset{0};
    bool shift = false, control = false;
};
bool is_wheel(const Scroll& scroll);
Eye scrolled(const Eye& eye, const Scroll& scroll, double height, const std::optional<glm::dvec3>& towards = {});

// The keys that are down: −1, 0 or 1 for each direction. W and S: forward; D and A: right; E and Q: up, along +Y.
struct FlightKeys {
    double forward = 0, right = 0, up = 0;
    bool fast = false, slow = false;  // Shift: four times as fast; Alt: a quarter
};
// The longest step of a flight: an image that took long must not throw the eye out of the scene.
constexpr double kMaxFlightStep_s = 0.1;
// Moves the pivot, and with it the eye. `scene_m` is the size of the scene: the eye crosses half of it in a second, and
// is not faster diagonally.
Eye flown(const Eye& eye, const FlightKeys& keys, double dt_s, double scene_m);

// Moves the eye so that the box (corners `low` and `high`, world) fills 0.9 of the width or of the height of the image,
// and its centre is the pivot. The direction stays. A box that is a point is looked at from 1 m. A box that is not
// finite, or has a coordinate beyond 1e9 m, changes nothing. `aspect` is the width of the image divided by its height.
Eye framed(const Eye& eye, glm::dvec3 low, glm::dvec3 high, double aspect);

// Looks at the pivot from the front (+Z, where performers look), from the right (+X), from above (with −Z up in the
// image), or from the other sides; without roll.
enum class EyeSide { kFront, kBack, kRight, kLeft, kTop, kBottom };
Eye seen_from(const Eye& eye, EyeSide side);

// The eye that sees as a camera does, roll included; its pivot is `distance_m` in front of it.
Eye looking_through(const glm::dmat4& world_from_camera, double angle_y, double distance_m);
// The depth of the centre of a box in front of a camera; half of the box's diagonal where the centre is behind it.
double distance_to(const glm::dmat4& world_from_camera, glm::dvec3 low, glm::dvec3 high);

// The eye on a flight between two others, with the smaller rotation: `from` at 0 s, exactly `to` from kEyeMove_s on.
constexpr double kEyeMove_s = 0.2;
Eye between(const Eye& from, const Eye& to, double elapsed_s);

}  // namespace neuvv::viewer
