#include "tools/viewer/report_facts.h"

namespace neuvv::viewer {

namespace {

// A JSON null where there is no value.
template <typename T>
nlohmann::json json_of(const std::optional<T>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

}  // namespace

void report_facts(const Context& context, const ReportedState& state) {
    Report& report = context.report;
    if (!report.enabled()) return;
    const FrameInput& frame = context.frame;
    const editor::Editor& editor = context.editor;
    const editor::DisplayedImage& displayed = frame.rendered.displayed;
    const Area& area = frame.image_area;
    report.area("image", area.left, area.top, area.width, area.height);
    report.fact("open", editor.is_open() ? editor.file().path.string() : "");
    report.fact("modified", editor.modified());
    report.fact("ready", frame.stage && frame.rendered.stage_id == editor.id() && displayed.view > 0);
    report.fact("view", displayed.view);
    report.fact("finished", state.image_is_sharp);
    report.fact("scale", displayed.scale);
    report.fact("image_ms", displayed.milliseconds);
    report.fact("time_s", context.view.clock.time_s());
    report.fact("playing", context.view.clock.playing);
    report.fact("along_path", context.view.along_path);
    report.fact("paint", {{"ready", state.paint.ready()},
                          {"busy", state.paint.busy()},
                          {"radius_m", state.paint.settings.radius_m},
                          {"depth_m", json_of(state.paint.hover_depth_m())}});
    report.fact("coach", state.coaching.facts());
    report.fact("verb", {{"open", state.verb.is_open()},
                         {"running", state.verb.is_running()},
                         {"progress", state.verb.progress()},
                         {"code", json_of(state.verb.code())}});
    report.fact("title", state.title);
    report.fact("latency_ms", state.meter.latency_ms());
    report.fact("worst_latency_ms", state.meter.max_latency_ms());
    report.fact("frame_ms", state.meter.frame_ms());
    report.fact("worst_frame_ms", state.meter.max_frame_ms());
    const ui::HandledInput handled = state.window.handled();
    report.fact("handled", {{"x", handled.x},
                            {"y", handled.y},
                            {"releases", handled.releases},
                            {"scrolls", handled.scrolls},
                            {"all", !state.window.has_more()}});
    report.fact("busy", context.jobs.under_way());
    report.fact("problem", frame.rendered.problem);
    report.fact("muted", context.view.muted);
    report.fact("solo", context.view.solo);
    report.fact("waits", frame.rendered.waits_since.has_value());
    report.fact("validation", state.validation_messages);
    report.fact("selected", json_of(editor.selected()));
    nlohmann::json notices = nlohmann::json::array();
    for (const editor::Notice& notice : state.notices) notices.push_back(notice.text);
    report.fact("notices", notices);
}

}  // namespace neuvv::viewer
