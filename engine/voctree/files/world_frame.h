// Where a clip lies in the coordinates of the capture that it was trained from. Clips and training hold floats, which
// do not resolve a performer 500 km from the origin, or of the size of a grain; a capture that stands or measures so is
// moved and scaled when it is read, and the clip remembers by how much.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "stream/transport/nvs_index.h"
#include "voctree/files/nvv.h"

namespace neuvv::voctree {

// The clip's point p is the capture's origin + unit · p. Directions are the same in both.
struct WorldFrame {
    glm::dvec3 origin{0};
    double unit = 1;

    bool is_same() const { return origin == glm::dvec3(0) && unit == 1; }  // whether both have the same coordinates
    glm::dvec3 to_capture(const glm::dvec3& p) const { return origin + unit * p; }
    glm::dvec3 from_capture(const glm::dvec3& p) const { return (p - origin) / unit; }
    // The same of a rigid pose.
    glm::dmat4 pose_to_capture(glm::dmat4 pose) const {
        pose[3] = glm::dvec4(to_capture(glm::dvec3(pose[3])), 1);
        return pose;
    }
    glm::dmat4 pose_from_capture(glm::dmat4 pose) const {
        pose[3] = glm::dvec4(from_capture(glm::dvec3(pose[3])), 1);
        return pose;
    }
    bool operator==(const WorldFrame&) const = default;
};

constexpr double kMaxWorldDistance = 1e12, kMinWorldUnit = 1e-12, kMaxWorldUnit = 1e12;

// The ancillary chunk of a .nvv in which the frame stands. Where both coordinates are the same, there is none.
class ChunkOfFrame {
  public:
    explicit ChunkOfFrame(const WorldFrame& frame);
    std::vector<NvvChunkView> views() const;  // for write_nvv, at most one; they refer to this object

  private:
    std::vector<NvvChunk> chunks_;
};

// The frame of a clip; of one in segments that of the first that can be read. A PlenOctree's coordinates are its own.
// Throws InputError where the file's headers are damaged, and as stream::Reader does for a stream.
WorldFrame read_world_frame(const std::filesystem::path& clip);

// The same frame as a stream says it: all that captures get are round numbers. Throws InputError for the frame of this
// clip where it is none.
stream::CaptureFrame frame_for_stream(const WorldFrame& frame, const std::filesystem::path& clip);

}  // namespace neuvv::voctree
