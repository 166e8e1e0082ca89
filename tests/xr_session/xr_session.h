// Runs the program `neuvv xr` against the test runtime, with a script of what head and hands do, and collects what both
// of them report.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "media/image.h"
#include "stage/stage_file.h"
#include "support/temporary_folder.h"

namespace neuvv::test {

// A script for the test runtime (tests/xr_runtime/README.md). Positions are in the world of the stage, which is set up
// so that the user stands at its origin and looks along −Z.
constexpr int kReady = 6;
struct XrScript {
    nlohmann::json json;

    XrScript();
    // From this frame on, head or hand is in this position. `hand` is "left" or "right"; it points at `points_at`.
    void head(int frame, glm::dvec3 at, glm::dvec3 looks_at);
    void hand(int frame, const std::string& hand, glm::dvec3 at, glm::dvec3 points_at);
    // The hand moves there from its last key, at a constant speed.
    void move_to(int frame, const std::string& hand, glm::dvec3 at, glm::dvec3 points_at);
    void input(int frame, const std::string& hand, const std::string& what, double value);
    void stick(int frame, const std::string& hand, glm::dvec2 value);
    // From this frame on, the eyes look there, from between them; or they are not tracked.
    void gaze(int frame, glm::dvec3 at, glm::dvec3 looks_at);
    void lose_gaze(int frame) { timeline_[frame]["gaze"] = nullptr; }
    void lose(int frame, const std::string& hand);
    // The system tracks this body from the frame on (`body` of the script's timeline).
    void body(int frame, nlohmann::json body) { timeline_[frame]["body"] = std::move(body); }
    // Presses a button for two frames. `frame` is at least kReady: before, the session has no input focus.
    void click(int frame, const std::string& hand, const std::string& what);
    void event(int frame, const std::string& what, nlohmann::json more = nlohmann::json::object());
    void save(int frame);
    void end(int frame) { json["end_frame"] = frame; }
    // The script as the runtime reads it.
    std::string text() const;

  private:
    std::map<int, nlohmann::json> timeline_;      // keys, by frame
    std::map<std::string, nlohmann::json> last_;  // the last key of each hand
};

struct XrRun {
    int code = 0;
    std::string log;        // stdout and stderr of the program
    nlohmann::json seen;    // the program's report (--report)
    nlohmann::json report;  // the runtime's report
    // An image of a saved frame; `which` is "left", "right", "left_seen" or "quad0".
    media::Image image(int frame, const std::string& which) const;
    std::filesystem::path out;
};

// The middle of anna, and the positions in which scripts begin with the hands.
constexpr glm::dvec3 kAnna(0, 0.8, -2), kRightHand(0.2, 1.2, -0.3), kLeftHand(-0.2, 1.2, -0.3);

// A stage with a disk as its floor and one performer, "anna", who is 1.6 m high and stands 2 m before the user.
class XrSession : public testing::Test {
  protected:
    XrSession();
    // Adds a performer of the clip to a stage: `corner` of its box, 1.6 m a side, in the world.
    void add_figure(stage::StageFile& file, const std::string& name, glm::dvec3 corner) const;
    // Writes headset.json, the settings of the program's next runs.
    void write_settings(const std::string& json) const;
    // Runs the program with OpenXR's core validation layer (with_layer) and `--validate`; both report in XrRun::log.
    // Without `validate`, neither layer is there. Throws where the program hangs.
    XrRun run(const XrScript& script, const std::vector<std::string>& more = {}, bool validate = true);
    // XrRun::out of the next run.
    std::filesystem::path next_out() const { return folder.path / ("run" + std::to_string(runs_ + 1)); }
    // The middles of the panel's items (tracking space) at a frame of the script, by name (replay.h).
    nlohmann::json panel_after(const XrScript& script, int end_frame) const;
    // The right hand points at an item of the panel and pulls the trigger. This takes kPress frames.
    static void press(XrScript& script, int frame, const nlohmann::json& items, const std::string& item);
    static constexpr int kPress = 8;
    // Expects that the runtime did not complain, and that the program ended cleanly.
    static void expect_sound(const XrRun& run);
    // The same, and that no validation layer complained.
    void expect_clean(const XrRun& run);
    nlohmann::json saved() const;
    static const nlohmann::json& node(const nlohmann::json& document, const std::string& name);
    static glm::dvec3 position(const nlohmann::json& node);
    static glm::dvec3 item_position(const nlohmann::json& item);  // of the panel

    int signal = 0;           // run() sends it to the program once a controller is there; 0: none
    std::string scale = "1";  // --scale of run(); empty: as the display's period allows
    bool with_layer = true;   // OpenXR's core validation layer; that of Debian 12 does not know bodies
    TemporaryFolder folder;
    std::filesystem::path stage = folder.path / "stage.gltf", clip = folder.path / "figure.nvv";

  private:
    int runs_ = 0;
};

// Whether no channel of two images differs by more than `step` (of 255).
bool same_pixels(const media::Image& a, const media::Image& b, int step = 1);

}  // namespace neuvv::test
