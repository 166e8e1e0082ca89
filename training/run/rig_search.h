// Finds what is wrong with a rig, before a run (`neuvv train --refine poses,time,auto`) or to report it (`neuvv dataset
// --rig`).
//
// A draft is trained at a few times of the clip. Between its steps, in rounds, all cameras move towards where the
// draft's images fit theirs (pose_probe.h, pose_solver.h), and later steps see through the moved cameras. The last
// rounds also compare images with the draft at the frames beside their own (time_probe.h). The draft is then thrown
// away: its tree was carved while the cameras were wrong, and keeps traces of that.
#pragma once

#include <functional>
#include <optional>

#include "training/run/train.h"
#include "training/step/colour_findings.h"

namespace neuvv::training {

// By camera of the data set.
struct RigFindings {
    RigChanges changes;             // the numbers for all cameras
    std::vector<double> late_by;    // the standard deviation of RigChanges::frames_late
    std::vector<double> roll_by;    // that of RigChanges::readout; both are infinite where too little moves
    std::vector<double> blur;       // by how many frames an exposure is longer than that of most cameras; 0: not known
    CameraColours colours;          // what TrainSettings::refine asks for
    std::vector<double> psnr;       // of the draft against some of the camera's tiles, dB; 0 where there are none
    std::vector<double> motion_px;  // by how much the change of the pose moves the image
    bool whole = false;             // all rounds were done
    double pixels = 1;              // the size of the draft's leaves in the last round
    double unsteady_px = 0;         // by how much the last rounds still moved images, root of the mean square
};

struct RigSearchProgress {
    double most_s = 0;   // that the search may take; 0: no bound
    uint64_t steps = 0;  // of the draft, done so far
    double fraction = 0, elapsed_s = 0, eta_s = 0;
    uint32_t rounds = 0;        // done so far
    double motion_px = 0;       // by how much the poses found so far move images: root of the mean square, pixels
    double last_motion_px = 0;  // by how much the last round moved them
};

// Called about once a second; returns false to stop the search.
using RigSearchCallback = std::function<bool(const RigSearchProgress&)>;

// Without `move_cameras`, all stay where they are, and only times are found (and colours): a camera that is late and
// one that stands elsewhere look alike, so that what moves them hides how late they are. Shape, seed, losses and
// `refine` are those of `settings`; of its budget in minutes or in steps, the search takes at most a fifth, but not
// fewer steps than its rounds need. Where minutes are spent before the draft is done, or the callback stops the search,
// what was found until then is returned; nothing where no round was done.
// Cameras without an image at the chosen times move only by what all have in common. Images of up to four frames are
// copied into memory. Throws InputError and RuntimeFailure as train() does.
std::optional<RigFindings> search_rig(const gpu::Device& device, const Dataset& dataset, const TrainSettings& settings,
                                      bool move_cameras, const RigSearchCallback& callback);

// The smallest findings that are worth correcting, beside those of colour_findings.h. A clean rig gives smaller ones.
constexpr double kWorthPixels = 0.3;    // motion of images by poses in the draft's leaves: root of the mean square
constexpr double kMostUnsteady = 0.25;  // of that motion: where the last rounds moved images by more, it is not found
constexpr double kWorthFrames = kMostOffFrame, kMostDeviation = 0.1;  // of how late any camera is
constexpr double kDeviations = 4;  // by how many standard deviations it has to be late

constexpr double kReadoutDeviations = 5, kMostRollDeviation = 0.2;  // of a readout, from kMostReadout on
constexpr double kWorthBlur = 0.4;  // of an exposure, to be told; clean rigs seem to have up to 0.2

// Whether a camera is late, and whether its shutter rolls, by these constants.
bool is_late(const RigFindings& findings, size_t camera);
bool is_rolling(const RigFindings& findings, size_t camera);

// The corrections that are worth making (`--refine auto`): those that the findings say with more certainty than a clean
// rig gives them.
struct Refinement {
    ColourRefinement colour;
    bool poses = false, time = false;
};
Refinement worthwhile(const RigFindings& findings);

}  // namespace neuvv::training
