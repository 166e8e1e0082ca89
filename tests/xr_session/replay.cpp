#include "xr_session/replay.h"

#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <map>
#include <string>
#include <vector>

#include "editor/open_file.h"
#include "tools/headset/coaching.h"
#include "tools/headset/panel.h"
#include "tools/headset/panel_surface.h"
#include "tools/headset/settings.h"
#include "tools/headset/standing.h"
#include "tools/ui/theme.h"
#include "voctree/nvv.h"

namespace neuvv::test {

namespace {

using nlohmann::json;
constexpr double kReplayPeriod_s = 1.0 / 90;
constexpr int kFocused = 6;  // before this frame, the session has no input

xr::Pose pose_of(const json& key) {
    const auto vec = [&](const char* name) {
        const json& list = key.at(name);
        return glm::dvec3(list[0], list[1], list[2]);
    };
    const glm::dvec3 turn = glm::radians(vec("turn_deg"));
    return {vec("at"), glm::angleAxis(turn.y, glm::dvec3(0, 1, 0)) * glm::angleAxis(turn.x, glm::dvec3(1, 0, 0))};
}

// The keys of one thing in a script's timeline, by frame.
using Track = std::map<int, json>;
Track track_of(const json& script, const json::json_pointer& what) {
    Track track;
    for (const json& key : script.at("timeline"))
        if (key.contains(what)) track[key.at("frame")] = key.at(what);
    return track;
}

json value_at(const Track& track, int frame) {
    const auto next = track.upper_bound(frame);
    return next == track.begin() ? json() : std::prev(next)->second;
}

// Interpolated, and constant before the first key and after the last.
std::optional<xr::Pose> pose_at(const Track& track, int frame) {
    if (track.empty()) return std::nullopt;
    const auto next = track.upper_bound(frame);
    if (next == track.begin()) return pose_of(next->second);
    const auto last = std::prev(next);
    const xr::Pose from = pose_of(last->second);
    if (next == track.end()) return from;
    const xr::Pose to = pose_of(next->second);
    const double part = double(frame - last->first) / (next->first - last->first);
    return xr::Pose{glm::mix(from.position, to.position, part), glm::slerp(from.rotation, to.rotation, part)};
}

// A hand's input at a frame. A button counts as pressed in the frame in which it goes down.
xr::HandInput input_at(const json& script, const std::string& hand, int frame) {
    xr::HandInput input;
    const json::json_pointer at("/" + hand);
    const json tracked = value_at(track_of(script, at / "tracked"), frame);
    if (tracked.is_null() || tracked.get<bool>()) {
        input.aim = pose_at(track_of(script, at / "aim"), frame);
        input.grip = pose_at(track_of(script, at / "grip"), frame);
    }
    const auto value = [&](const char* what, int of_frame) {
        return value_at(track_of(script, json::json_pointer("/input") / ("/user/hand/" + hand + "/input/" + what)),
                        of_frame);
    };
    const auto amount = [&](const char* what) {
        return value(what, frame).is_null() ? 0.0 : value(what, frame).get<double>();
    };
    const auto goes_down = [&](const char* what) {
        return value(what, frame) == true && value(what, frame - 1) != true;
    };
    if (frame < kFocused) return input;
    input.select = amount("trigger/value");
    input.grab = amount("squeeze/value");
    if (const json stick = value("thumbstick", frame); !stick.is_null()) input.stick = {stick[0], stick[1]};
    input.menu = goes_down("y/click");
    input.play = goes_down("a/click");
    input.undo = goes_down("x/click");
    input.duplicate = goes_down("b/click");
    return input;
}

// What a frame of the program does between the runtime's poses and the images.
struct Replay {
    Replay(const std::filesystem::path& stage, const std::filesystem::path& settings) {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {headset::kPanelWidth, headset::kPanelHeight};
        io.DeltaTime = float(kReplayPeriod_s);
        ui::apply_theme(headset::kPanelScale);
        io.Fonts->Build();
        state.editor.open(editor::open_document(stage), false);
        state.follow_document();
        headset::HeadsetSettings(settings).load(state, interaction.grab.settings);
    }
    ~Replay() {
        jobs.stop();
        ImGui::DestroyContext();
    }
    Replay(const Replay&) = delete;
    Replay& operator=(const Replay&) = delete;

    void find_solid_parts() {
        state.solid.resize(state.stage->performers.size());
        for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
            const auto& clip = state.stage->clips[state.stage->performers[performer.performer].clip];
            auto& leaves = solid[clip.path];
            if (!leaves) leaves = std::make_shared<const voctree::SolidLeaves>(voctree::read_nvv(clip.path));
            state.solid[performer.performer] = {leaves, performer.frame};
        }
    }
    void frame(const xr::HandInputs& inputs, const xr::Pose& head) {
        jobs.run_posted();
        state.follow_document();
        state.clock.tick(kReplayPeriod_s);
        state.evaluate();
        find_solid_parts();
        if (!stands) headset::stand_at(state, headset::first_place(state), head);
        stands = true;
        interaction.update(state, inputs, head, kReplayPeriod_s);
        if (!interaction.panel || state.is_behind()) return;
        const headset::PanelPointer pointer = interaction.panel_pointer();
        ImGuiIO& io = ImGui::GetIO();
        io.MousePos = pointer.uv ? ImVec2{float(pointer.uv->x) * headset::kPanelWidth,
                                          float(pointer.uv->y) * headset::kPanelHeight}
                                 : ImVec2{-FLT_MAX, -FLT_MAX};
        io.MouseDown[0] = pointer.pressed;
        ImGui::NewFrame();
        headset::PanelStatus status;
        status.head = head;
        items = headset::draw_panel(state, interaction, coaching, status).items;
        ImGui::Render();
    }

    headset::HeadsetState state;
    JobQueue jobs = JobQueue([](const std::string&) {}, [] {});
    headset::Interaction interaction = headset::Interaction(jobs);
    headset::Coaching coaching = headset::Coaching(jobs);
    std::map<std::filesystem::path, std::shared_ptr<const voctree::SolidLeaves>> solid;  // of clips
    std::map<std::string, glm::dvec2> items;
    bool stands = false;
};

}  // namespace

json panel_items_after(const json& script, int end_frame, const std::filesystem::path& stage,
                       const std::filesystem::path& settings) {
    Replay replay(stage, settings);
    const Track head = track_of(script, json::json_pointer("/head"));
    for (int frame = 0; frame <= end_frame; ++frame)
        replay.frame({input_at(script, "left", frame), input_at(script, "right", frame)}, *pose_at(head, frame));
    json items = json::object();
    if (!replay.interaction.panel) return items;
    const xr::Pose tracking = xr::inverse(xr::world_from_tracking(replay.state.rig));
    for (const auto& [name, uv] : replay.items) {
        const glm::dvec3 at = tracking * replay.interaction.panel->point_at(uv);
        items[name] = {at.x, at.y, at.z};
    }
    return items;
}

}  // namespace neuvv::test
