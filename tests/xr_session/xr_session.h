// The program in a headset: `neuvv xr` against the test runtime, with a script of what head and hands do, and what came
// of it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "media/image.h"
#include "support/temporary_folder.h"

namespace neuvv::test {

// A script of the test runtime (tests/xr_runtime/README.md), in the stage's world: it is made so that the user stands
// at its origin and looks along −Z.
struct XrScript {
    nlohmann::json json;

    XrScript();
    // From this frame on; `hand` is "left" or "right". The hand points at a place.
    void head(int frame, glm::dvec3 at, glm::dvec3 looks_at);
    void hand(int frame, const std::string& hand, glm::dvec3 at, glm::dvec3 points_at);
    void input(int frame, const std::string& hand, const std::string& what, double value);
    void stick(int frame, const std::string& hand, glm::dvec2 value);
    void loses(int frame, const std::string& hand);
    // A press of two frames.
    void click(int frame, const std::string& hand, const std::string& what);
    void event(int frame, const std::string& what, nlohmann::json more = nlohmann::json::object());
    void save(int frame);
    void end(int frame) { json["end_frame"] = frame; }

  private:
    nlohmann::json& at(int frame);
};

struct XrRun {
    int code = 0;
    std::string log;        // of both its outputs
    nlohmann::json report;  // the runtime's
    // Of a saved frame: "left", "right", "left_seen", "quad0".
    Image picture(int frame, const std::string& which) const;
    std::filesystem::path out;
};

// A stage of one performer, "anna", 1.6 m high on the floor 2 m before the user, on a disk of its own.
class XrSession : public testing::Test {
  protected:
    XrSession();
    // Throws where the program hangs. The core validation layer reports on its output, as `--validate` does.
    XrRun run(const XrScript& script, const std::vector<std::string>& more = {});
    // Nothing that a runtime or a layer could complain of, and a clean end.
    void expect_clean(const XrRun& run);
    nlohmann::json saved() const;
    static const nlohmann::json& node(const nlohmann::json& document, const std::string& name);
    static glm::dvec3 place(const nlohmann::json& node);

    TemporaryFolder folder;
    std::filesystem::path stage = folder.path / "stage.gltf", clip = folder.path / "figure.nvv";

  private:
    int runs_ = 0;
};

// Whether two pictures are the same but for one step of 255.
bool same_pixels(const Image& a, const Image& b, int step = 1);

}  // namespace neuvv::test
