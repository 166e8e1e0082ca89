// The camera of the viewer's eye: where it is, and how mouse, keys and touchpad move it.
//
// An Eye looks at a pivot. World: +Y up, metres. Angles in radians. Every verb takes an eye and gives the moved one;
// what is not named stays. Pixels: x to the right, y down; `height` is that of the image, so that the same drag turns
// as far on every screen. Distances and angles stay within the limits below.
//
//   left drag          orbited            the scene follows the pointer, about the pivot
//   middle drag        panned             the grabbed point of the pivot's plane follows the pointer
//   right drag         turned             looks around, standing still; with W A S D Q E held: flown
//   wheel              dollied            towards what is under the pointer
//   touchpad, two fingers                 orbits; with Shift pans; with Ctrl dollies (as Blender does)
#pragma once

#include <optional>

#include "stage/camera.h"

namespace neuvv::viewer {

struct Eye {
    glm::dvec3 pivot{0};
    double yaw = 0;        // about +Y: 0 looks along −Z, π/2 along −X
    double pitch = 0;      // −π/2 down … π/2 up
    double roll = 0;       // about the axis of view, after the others: only looking_through leaves one
    double distance = 3;   // from the pivot, metres
    double angle_y = 0.6;  // the whole vertical angle of view
    bool operator==(const Eye&) const = default;
};

constexpr double kMinEyeDistance_m = 1e-2, kMaxEyeDistance_m = 1e5;
constexpr double kMinEyeAngle = 0.01, kMaxEyeAngle = 2.6;

glm::dmat4 world_from_eye(const Eye& eye);  // as Camera::world_from_camera
// Square pixels, the principal point in the middle.
stage::Camera camera_of(const Eye& eye, uint32_t width, uint32_t height);

// A drag over the image's height is half a turn. Over the poles it does not go.
Eye orbited(const Eye& eye, glm::dvec2 moved_px, double height);
// The same angles about the eye itself: it looks where the pointer goes, as in games.
Eye turned(const Eye& eye, glm::dvec2 moved_px, double height);
// Exact: a point at the pivot's depth stays under the pointer.
Eye panned(const Eye& eye, glm::dvec2 moved_px, double height);
// Each notch takes a tenth of the way to the pivot, or (negative) puts it back. With a point that is seen, that point
// stays where it is in the image, and the pivot comes along.
Eye dollied(const Eye& eye, double notches, const std::optional<glm::dvec3>& towards = {});

// Scrolling as GLFW reports it. Whole numbers in y alone are a wheel, whatever is held: a notch up is a notch closer.
// Anything else are two fingers on a touchpad.
struct Scroll {
    glm::dvec2 offset{0};
    bool shift = false, control = false;
};
bool is_wheel(const Scroll& scroll);
Eye scrolled(const Eye& eye, const Scroll& scroll, double height, const std::optional<glm::dvec3>& towards = {});

// Keys that are down: −1, 0 or 1 each. W/S forward, D/A right, E/Q up the world.
struct FlightKeys {
    double forward = 0, right = 0, up = 0;
    bool fast = false, slow = false;  // Shift: four times as fast; Alt: a quarter
};
constexpr double kLongestFlight_s = 0.1;  // in one step, so that an image that took long throws nobody out
// `scene_m`: the scene's size. A second crosses half of it; diagonally no faster.
Eye flown(const Eye& eye, const FlightKeys& keys, double dt_s, double scene_m);

// The box in the image, as large as fits with a tenth of the half image left free; its middle is the pivot. The
// direction stays. A point is looked at from 1 m. A box that is not finite, or farther out than 1e9 m, changes nothing.
// `aspect`: the image's width by its height.
Eye framed(const Eye& eye, glm::dvec3 low, glm::dvec3 high, double aspect);

// From the front (+Z, where performers look), the right (+X), above (−Z is up in the image), and the other sides.
// Level.
enum class EyeSide { kFront, kBack, kRight, kLeft, kTop, kBottom };
Eye seen_from(const Eye& eye, EyeSide side);

// As a camera sees, roll included; the pivot `distance_m` in front of it.
Eye looking_through(const glm::dmat4& world_from_camera, double angle_y, double distance_m);
// How far in front of a camera the middle of a box lies; half of its diagonal where that is behind the camera.
double distance_to(const glm::dmat4& world_from_camera, glm::dvec3 low, glm::dvec3 high);

// On the way from one eye to another, the shorter way around: `from` at 0, exactly `to` from kEyeMove_s on.
constexpr double kEyeMove_s = 0.2;
Eye between(const Eye& from, const Eye& to, double elapsed_s);

}  // namespace neuvv::viewer
