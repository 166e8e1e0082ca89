// The program in a headset: `neuvv xr` against the test runtime, with a script of what head and hands do, and what came
// of it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "media/image.h"
#include "support/temporary_folder.h"

namespace neuvv::test {

// A script of the test runtime (tests/xr_runtime/README.md), in the stage's world: it is made so that the user stands
// at its origin and looks along −Z.
constexpr int kReady = 6;
struct XrScript {
    nlohmann::json json;

    XrScript();
    // From this frame on, at once; `hand` is "left" or "right". The hand points at a place.
    void head(int frame, glm::dvec3 at, glm::dvec3 looks_at);
    void hand(int frame, const std::string& hand, glm::dvec3 at, glm::dvec3 points_at);
    // It comes there from where it was last, evenly.
    void moves(int frame, const std::string& hand, glm::dvec3 at, glm::dvec3 points_at);
    void input(int frame, const std::string& hand, const std::string& what, double value);
    void stick(int frame, const std::string& hand, glm::dvec2 value);
    void loses(int frame, const std::string& hand);
    // A press of two frames, from kReady on at the earliest: before, a session has no focus.
    void click(int frame, const std::string& hand, const std::string& what);
    void event(int frame, const std::string& what, nlohmann::json more = nlohmann::json::object());
    void save(int frame);
    void end(int frame) { json["end_frame"] = frame; }
    // As the runtime reads it.
    std::string text() const;

  private:
    std::map<int, nlohmann::json> timeline_;      // by frame
    std::map<std::string, nlohmann::json> last_;  // pose of a hand
};

struct XrRun {
    int code = 0;
    std::string log;        // of both its outputs
    nlohmann::json seen;    // its own report
    nlohmann::json report;  // the runtime's
    // Of a saved frame: "left", "right", "left_seen", "quad0".
    media::Image image(int frame, const std::string& which) const;
    std::filesystem::path out;
};

// In the middle of anna, and where the hands of scripts are at first.
constexpr glm::dvec3 kAnna(0, 0.8, -2), kRightHand(0.2, 1.2, -0.3), kLeftHand(-0.2, 1.2, -0.3);

// A stage of one performer, "anna", 1.6 m high on the floor 2 m before the user, on a disk of its own.
class XrSession : public testing::Test {
  protected:
    XrSession();
    // Throws where the program hangs. The core validation layer reports on its output, as `--validate` does.
    XrRun run(const XrScript& script, const std::vector<std::string>& more = {});
    // What the panel shows once the script has been gone through: the middles of its items, tracking space.
    nlohmann::json panel_after(XrScript script, int end_frame);
    // The right hand points at a panel's item and pulls the trigger. Takes kPress frames.
    static void press(XrScript& script, int frame, const nlohmann::json& items, const std::string& item);
    static constexpr int kPress = 8;
    // Nothing that a runtime or a layer could complain of, and a clean end.
    void expect_clean(const XrRun& run);
    nlohmann::json saved() const;
    static const nlohmann::json& node(const nlohmann::json& document, const std::string& name);
    static glm::dvec3 place(const nlohmann::json& node);
    static glm::dvec3 place_of(const nlohmann::json& item);  // of the panel

    TemporaryFolder folder;
    std::filesystem::path stage = folder.path / "stage.gltf", clip = folder.path / "figure.nvv";

  private:
    int runs_ = 0;
};

// Whether two images are the same but for one step of 255.
bool same_pixels(const media::Image& a, const media::Image& b, int step = 1);

}  // namespace neuvv::test
