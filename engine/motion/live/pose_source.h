// Where a trainee's poses come from while a clip plays.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "motion/live/pose_line.h"

namespace neuvv::motion {

// What to tell the person about a source.
struct PoseSourceState {
    uint64_t poses = 0;       // that arrived so far
    uint64_t left_out = 0;    // packets and lines that were malformed, came too late, or came from another sender
    std::string first_error;  // about the first of those; empty: none
    bool stopped = false;     // poses came, and none has come for a second, or the file has ended
};

// A source never makes its caller wait, and takes no more memory the longer it runs.
class PoseSource {
  public:
    virtual ~PoseSource() = default;
    // The newest pose that has arrived since the last call; nothing where none has. `now_s` is the caller's clock, in
    // seconds: it never runs backwards, and the pose's time_s is on it.
    virtual std::optional<TimedPose> newest(double now_s) = 0;
    // A recorded motion goes on from to_s, in seconds from its beginning; live motion is not affected.
    virtual void rewind(double /*now_s*/, double /*to_s*/) {}
    virtual bool is_recorded() const { return false; }
    virtual PoseSourceState state() const = 0;
    virtual std::string name() const = 0;  // "VMC on 127.0.0.1:39539"
    // What to do where no pose comes.
    virtual std::string advice() const { return "write one pose a line, as engine/motion/README.md says"; }
};

// Opens a source by what a user writes:
//   vmc, vmc:PORT, vmc:HOST:PORT     the VMC protocol (OSC over UDP); 127.0.0.1:39539 where nothing else is said
//   udp:PORT, udp:HOST:PORT          lines of JSON (pose_line.h), a UDP packet each, on 127.0.0.1 unless HOST is given
//   -                                lines of JSON from stdin
//   FILE                             a recorded motion (.jsonl, and what read_skeleton reads) at its own pace, which
//                                    begins with the first call of newest()
// HOST is an address in digits; 0.0.0.0 listens to the whole network. A PORT of 0 takes one that is free; name() says
// which. Throws InputError with the address and the fix, for a port that is in use, too.
std::unique_ptr<PoseSource> open_pose_source(const std::string& address);
// Whether an address is of the first two kinds, which have no end.
bool is_port_address(const std::string& address);

}  // namespace neuvv::motion
