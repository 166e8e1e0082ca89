#include "xr_session/xr_session.h"

#include <fstream>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "edit/operations.h"
#include "support/child_process.h"
#include "support/figure.h"
#include "voctree/nvv.h"
#include "xr_session/replay.h"

namespace neuvv::test {

namespace {

using nlohmann::json;
constexpr auto kTimeout = std::chrono::minutes(4);

std::string read_text(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

json list(glm::dvec3 v) {
    return {v.x, v.y, v.z};
}

json pose(glm::dvec3 at, glm::dvec3 looks_at) {
    const glm::dvec3 direction = glm::normalize(looks_at - at);
    return {{"at", list(at)},
            {"turn_deg",
             list(glm::degrees(glm::dvec3(std::asin(direction.y), std::atan2(-direction.x, -direction.z), 0)))}};
}

}  // namespace

XrScript::XrScript()
    : json{{"width", 192},
           {"height", 192},
           {"fov_deg", {{-42, 38, 40, -44}, {-38, 42, 40, -44}}},
           {"events", json::array()},
           {"save_frames", json::array()}} {
    head(0, {0, 1.5, 0}, {0, 1.2, -2});
}

std::string XrScript::text() const {
    nlohmann::json whole = json;
    whole["timeline"] = nlohmann::json::array();
    for (const auto& [frame, key] : timeline_) {
        whole["timeline"].push_back(key);
        whole["timeline"].back()["frame"] = frame;
    }
    return whole.dump(1);
}

void XrScript::head(int frame, glm::dvec3 position, glm::dvec3 looks_at) {
    timeline_[frame]["head"] = pose(position, looks_at);
}

void XrScript::hand(int frame, const std::string& hand, glm::dvec3 position, glm::dvec3 points_at) {
    if (last_.contains(hand) && frame > 0 && !timeline_[frame - 1].contains(hand))
        timeline_[frame - 1][hand] = last_[hand];
    move_to(frame, hand, position, points_at);
}

void XrScript::move_to(int frame, const std::string& hand, glm::dvec3 position, glm::dvec3 points_at) {
    timeline_[frame][hand] = {
        {"grip", pose(position, points_at)}, {"aim", pose(position, points_at)}, {"tracked", true}};
    last_[hand] = timeline_[frame][hand];
}

void XrScript::gaze(int frame, glm::dvec3 position, glm::dvec3 looks_at) {
    timeline_[frame]["gaze"] = pose(position, looks_at);
}

void XrScript::lose(int frame, const std::string& hand) {
    timeline_[frame][hand] = {{"tracked", false}};
}

void XrScript::input(int frame, const std::string& hand, const std::string& what, double value) {
    nlohmann::json as = value;
    if (what.ends_with("/click")) as = value != 0;
    timeline_[frame]["input"]["/user/hand/" + hand + "/input/" + what] = as;
}

void XrScript::stick(int frame, const std::string& hand, glm::dvec2 value) {
    timeline_[frame]["input"]["/user/hand/" + hand + "/input/thumbstick"] = {value.x, value.y};
}

void XrScript::click(int frame, const std::string& hand, const std::string& what) {
    input(frame, hand, what, 1);
    input(frame + 2, hand, what, 0);
}

void XrScript::event(int frame, const std::string& what, nlohmann::json more) {
    more["frame"] = frame;
    more["do"] = what;
    json["events"].push_back(more);
}

void XrScript::save(int frame) {
    json["save_frames"].push_back(frame);
}

media::Image XrRun::image(int frame, const std::string& which) const {
    char name[64];
    std::snprintf(name, sizeof(name), "frame_%04d_%s.png", frame, which.c_str());
    return media::read_png(out / name);
}

void XrSession::add_figure(stage::StageFile& file, const std::string& name, glm::dvec3 corner) const {
    edit::PerformerEdit performer;
    performer.clip = clip;
    edit::Placement placement;
    placement.matrix = glm::translate(glm::dmat4(1), corner) * glm::scale(glm::dmat4(1), glm::dvec3(1.6));
    edit::add_performer(file, name, performer, placement);
}

XrSession::XrSession() {
    voctree::write_nvv(clip, figure_tree());
    stage::StageFile file = edit::new_stage(stage);
    add_figure(file, "anna", {-0.8, 0, -2.8});
    edit::Placement eyes;
    eyes.at = glm::dvec3(0, 1.5, 0);
    eyes.aim = glm::dvec3(0, 1.5, -1);
    edit::place_node(file, edit::find_node(file, "camera"), eyes);
    stage::save_stage_file(file, stage);
    write_settings(R"({"hands": {"hints": false}})");  // so that images show the stage alone
}

void XrSession::write_settings(const std::string& json) const {
    std::filesystem::create_directories(folder.path / "config/neuvv");
    std::ofstream(folder.path / "config/neuvv/headset.json") << json;
}

XrRun XrSession::run(const XrScript& script, const std::vector<std::string>& more, bool validate) {
    XrRun run;
    run.out = next_out();
    ++runs_;
    std::filesystem::create_directories(run.out);
    const std::filesystem::path path = run.out / "script.json", log = run.out / "log.txt";
    std::ofstream(path) << script.text();
    std::vector<std::string> arguments{
        "/usr/bin/env",
        std::string("XR_RUNTIME_JSON=") + NEUVV_XR_RUNTIME,
        std::string("XR_ENABLE_API_LAYERS=") + (with_layer && validate ? "XR_APILAYER_LUNARG_core_validation" : ""),
        "XR_CORE_VALIDATION_EXPORT_TYPE=text",
        "XR_CORE_VALIDATION_FILE_NAME=" + (run.out / "validation.txt").string(),
        "NEUVV_XR_SCRIPT=" + path.string(),
        "NEUVV_XR_OUT=" + run.out.string(),
        "XDG_STATE_HOME=" + (folder.path / "state").string(),
        "XDG_CONFIG_HOME=" + (folder.path / "config").string(),
        NEUVV_PROGRAM,
        "xr",
        stage.string(),
        "--report",
        (run.out / "seen.json").string()};
    if (validate) arguments.emplace_back("--validate");
    if (!scale.empty()) arguments.insert(arguments.end(), {"--scale", scale});
    arguments.insert(arguments.end(), more.begin(), more.end());
    ChildProcess program(arguments, log);
    const auto end = std::chrono::steady_clock::now() + kTimeout;
    for (bool sent = signal == 0; !program.ended();) {
        if (!sent && read_text(log).find("right hand: ") != std::string::npos) {
            program.send(signal);
            sent = true;
        }
        if (std::chrono::steady_clock::now() > end) throw std::runtime_error("the program hangs: " + read_text(log));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    run.code = program.wait();
    run.log = read_text(log);
    run.seen = json::parse(read_text(run.out / "seen.json"), nullptr, false);
    run.report = json::parse(read_text(run.out / "report.json"), nullptr, false);
    return run;
}

json XrSession::panel_after(const XrScript& script, int end_frame) const {
    return panel_items_after(json::parse(script.text()), end_frame, stage, folder.path / "config/neuvv/headset.json");
}

void XrSession::press(XrScript& script, int frame, const json& items, const std::string& item) {
    if (!items.contains(item)) throw std::runtime_error("the panel has no " + item);
    script.hand(frame, "right", kRightHand, item_position(items[item]));
    script.input(frame + 2, "right", "trigger/value", 1);
    script.input(frame + 5, "right", "trigger/value", 0);
}

void XrSession::expect_sound(const XrRun& run) {
    EXPECT_EQ(run.code, 0) << run.log;
    ASSERT_TRUE(run.report.is_object()) << run.log;
    EXPECT_EQ(run.report["violations"], json::array());
    EXPECT_EQ(run.report["warnings"], json::array());
    EXPECT_EQ(run.report["destroyed_cleanly"], true);
}

void XrSession::expect_clean(const XrRun& run) {
    expect_sound(run);
    EXPECT_EQ(run.log.find("Core Validation output type: text") != std::string::npos, with_layer);
    const std::string layer =
        read_text(run.out / "validation.txt");  // the layer creates this file with its first complaint
    EXPECT_EQ(layer.find("VUID"), std::string::npos) << layer;
    EXPECT_EQ(run.log.find("validation:"), std::string::npos) << run.log;
}

json XrSession::saved() const {
    return json::parse(read_text(stage));
}

const json& XrSession::node(const json& document, const std::string& name) {
    for (const json& one : document.at("nodes"))
        if (one.value("name", "") == name) return one;
    throw std::runtime_error("there is no node " + name);
}

glm::dvec3 XrSession::item_position(const json& item) {
    return {item.at(0), item.at(1), item.at(2)};
}

glm::dvec3 XrSession::position(const json& node) {
    if (node.contains("matrix")) return {node["matrix"][12], node["matrix"][13], node["matrix"][14]};
    const auto at = node.value("translation", std::vector<double>{0, 0, 0});
    return {at[0], at[1], at[2]};
}

bool same_pixels(const media::Image& a, const media::Image& b, int step) {
    if (a.width != b.width || a.height != b.height) return false;
    for (size_t i = 0; i < a.rgba.size(); ++i)
        if (std::abs(a.rgba[i] - b.rgba[i]) > step) return false;
    return true;
}

}  // namespace neuvv::test
