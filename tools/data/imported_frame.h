// Frames that other programs wrote, as neuvv import reads them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "stage/camera.h"
#include "voctree/voctree.h"

namespace neuvv::tools {

enum class Up { kY, kMinusY, kZ };
constexpr const char* kUpNames[] = {"y", "-y", "z"};

struct FrameImportOptions {
    std::string input, output, box, size = "720x720";
    std::optional<Up> up;
    double scale = 1, fps = 25;
    uint32_t resolution = 256, views = 8;
    bool json = false;
};

// Why a frame shows nothing, after its name, and what to do.
struct EmptyFrame {
    std::string problem, fix;
};

// A frame as it was read.
class ImportedFrame {
  public:
    virtual ~ImportedFrame() = default;
    virtual voctree::VOctree tree() const = 0;
    // Drawn from what was read, without cells.
    virtual media::Image image(const stage::Camera& camera, const glm::vec3& background) const = 0;
    // Where the tree has no leaves.
    virtual EmptyFrame why_empty() const = 0;
    // What was left out, and what was chosen among several.
    virtual std::vector<std::string> notes() const = 0;
};

// A kind of input. The first frame that shows something decides how large cells are in all of them.
class FrameImport {
  public:
    virtual ~FrameImport() = default;
    virtual std::unique_ptr<ImportedFrame> read(const std::filesystem::path& file) = 0;
};

// By the ending of the input. The options must outlive it. Throws InputError.
std::unique_ptr<FrameImport> import_of(const FrameImportOptions& options);

// Throws RuntimeFailure where the program was asked to stop.
void expect_to_go_on(const std::string& output);

}  // namespace neuvv::tools
