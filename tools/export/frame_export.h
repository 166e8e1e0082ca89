// What a kind of `neuvv export` does with the frames of a clip. export_run.cpp calls it; export.cpp lists the kinds.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "interchange/mesh/clip_mesh.h"
#include "tools/commands.h"
#include "tools/publish/encode_scene.h"
#include "voctree/files/plenoctree.h"

namespace neuvv::tools {

// The images of kinds that do not give them another size.
constexpr const char* kFrameSize = "720x720";

struct ExportOptions {
    std::string scene, performer, output, kind, frames;
    std::string size;           // of images; empty: as is usual for the kind
    std::string camera, world;  // of kinds that write cameras
    std::string splats;         // of the kind layout
    std::optional<double> fps;
    std::optional<uint32_t> most_splats;  // of each frame; 0: no limit; none: as is usual for the kind
    uint32_t views = 8;
    double time_s = 0;  // of the stage, for the kind stand-ins
    interchange::MeshSettings mesh;
    EncodingOptions encoding;   // of streams, for the kind web
    std::optional<double> iso;  // opacity of a surface, 0 to 1
    std::optional<voctree::UpAxis> up;
    bool stage_space = false, resume = false, json = false;
};

// Of work that takes long: shows what is being done, and throws RuntimeFailure where the user wants to stop.
using Working = std::function<void(std::string_view what)>;

class ExportedClip;

class FrameExport {
  public:
    virtual ~FrameExport() = default;

    // Whether a file can hold more than one frame.
    virtual bool holds_many() const = 0;

    // What one frame takes on the disk, judged by `frame`, and of what it is: "about 20000 splats".
    struct Estimate {
        uint64_t bytes = 0;
        std::string what;
    };
    virtual Estimate estimate(uint32_t frame) = 0;

    // Measures on `frame` what is lost, and sets what all frames share. It is called once, after estimate() of the same
    // frame and before add().
    virtual void measure(uint32_t frame, const Working& working) = 0;

    // Takes a frame into what the next write() writes.
    virtual void add(uint32_t frame, const Working& working) = 0;

    // Writes all frames that were added since the last one, atomically.
    virtual void write(const std::filesystem::path& file) = 0;

    // What write() has written: some kinds write other files beside that one.
    virtual std::vector<std::filesystem::path> files_of(const std::filesystem::path& file) const { return {file}; }

    // What was written and what was lost, for --json and for people: "5000 splats; images ... have 38.5 dB".
    virtual void report(nlohmann::ordered_json& json) const = 0;
    virtual std::string summary() const = 0;
};

// `ending` is that of the output, as in ".ply"; it is one of the kind's. The clip must outlive the result.
std::unique_ptr<FrameExport> export_splats(const ExportOptions& options, const std::string& ending, ExportedClip& clip,
                                           const CommonOptions& common);
std::unique_ptr<FrameExport> export_plenoctree(const ExportOptions& options, const std::string& ending,
                                               ExportedClip& clip, const CommonOptions& common);
std::unique_ptr<FrameExport> export_volumes(const ExportOptions& options, const std::string& ending, ExportedClip& clip,
                                            const CommonOptions& common);

std::unique_ptr<FrameExport> export_meshes(const ExportOptions& options, const std::string& ending, ExportedClip& clip,
                                           const CommonOptions& common);

}  // namespace neuvv::tools
