// `viewer_measure STAGE` measures how long a user waits, with real events in a window of 960×540. It prints what the
// program's report says: the worst values since the window opened. It is a measurement and not a test: nothing is
// compared with a limit.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "support/temporary_folder.h"
#include "viewer_window/hands.h"

namespace neuvv::test {
namespace {

struct Waits {
    double input_ms = 0, frame_ms = 0;
};

Waits waits_of(const Hands& hands) {
    const nlohmann::json now = hands.seen();
    return {now["worst_latency_ms"], now["worst_frame_ms"]};
}

void print(const char* what, const Waits& waits) {
    const std::string input = waits.input_ms > 0 ? fmt::format("{:.0f} ms", waits.input_ms) : "-";
    fmt::print("{:<34}{:>18}{:>16.0f} ms\n", what, input, waits.frame_ms);
    std::fflush(stdout);
}

// The name of the first performer of the timeline.
std::string first_performer(const Hands& hands) {
    const nlohmann::json items = hands.seen()["items"];
    const std::string begin = "timeline/", end = "/menu";
    for (const auto& [name, area] : items.items())
        if (name.starts_with(begin) && name.ends_with(end))
            return name.substr(begin.size(), name.size() - begin.size() - end.size());
    throw std::runtime_error("no performer on this stage");
}

struct Measure {
    const VirtualScreen& screen;
    const std::filesystem::path& folder;
    std::string stage;

    template <typename Act>
    void operator()(const char* what, Act&& act) const {
        // A folder of its own, so that no edits are left for the next measurement to recover.
        const std::filesystem::path own_folder = folder / what;
        std::filesystem::create_directory(own_folder);
        Hands hands(screen, own_folder, {stage, "--size", "960x540"}, false);
        hands.until_rest();
        act(hands);
        print(what, waits_of(hands));
        hands.kill();
    }
};

void measure(const Measure& measure) {
    fmt::print("{:<34}{:>18}{:>19}\n", "worst of", "input to image", "window's frame");
    measure("opening", [](Hands&) {});
    measure("orbiting", [](Hands& hands) {
        for (int i = 0; i < 3; ++i) hands.drag(hands.in_image(0.2, 0.8), hands.in_image(0.8, 0.7));
    });
    measure("moving a performer", [](Hands& hands) {
        hands.click("stage/" + first_performer(hands));
        const Spot arrow = hands.centre_of("gizmo/x");
        for (int i = 0; i < 3; ++i) {
            hands.drag(arrow, {arrow.x + 60, arrow.y});
            hands.key("ctrl+z");
            hands.until_rest();
        }
    });
    measure("turning up a light", [](Hands& hands) {
        hands.click("stage/key");
        hands.click("tab/light");
        const Spot field = hands.centre_of("light/intensity");
        for (int i = 0; i < 3; ++i) hands.drag(field, {field.x + 40, field.y});
    });
    measure("painting", [](Hands& hands) {
        hands.click("stage/" + first_performer(hands));
        const Spot chest = hands.centre_of("gizmo/y");
        hands.click("tab/paint");
        hands.click("paint/colour");
        for (int i = 0; i < 3; ++i) hands.drag({chest.x - 10, chest.y - 20.0 * i}, {chest.x + 10, chest.y});
        hands.until("a stroke", [](const nlohmann::json& now) { return now["modified"] == true; });
        hands.until_rest();
    });
    measure("playing", [](Hands& hands) {
        hands.key("space");
        hands.until("two seconds of it", [](const nlohmann::json& now) { return now["view"] > 60; });
        hands.key("space");
    });
    measure("saving", [](Hands& hands) {
        hands.click("stage/" + first_performer(hands));
        hands.key("ctrl+d");
        hands.until("an edit", [](const nlohmann::json& now) { return now["modified"] == true; });
        hands.key("ctrl+s");
        hands.until("all to be saved", [](const nlohmann::json& now) { return now["modified"] == false; });
        hands.until_rest();
        hands.key("ctrl+z");
        hands.key("ctrl+s");
        hands.until_rest();
    });
    measure("looking around while it exports", [](Hands& hands) {
        hands.click("tab/render");
        hands.wheel(hands.centre_of("render/Image"), -20);
        hands.click("export/720p");
        hands.click("export/start");
        hands.click("question/Save");
        hands.centre_of("export/progress");
        for (int i = 0; i < 3; ++i) hands.drag(hands.in_image(0.2, 0.8), hands.in_image(0.8, 0.7));
        hands.click("export/cancel");
        hands.until_notice("export");
    });
}

}  // namespace
}  // namespace neuvv::test

int main(int argc, char** argv) {
    using namespace neuvv;
    if (const std::string why = test::why_no_hands(); !why.empty() || argc != 2) {
        fmt::print(stderr, "{}\n", why.empty() ? "usage: viewer_measure STAGE" : why);
        return 2;
    }
    try {
        const TemporaryFolder folder;
        std::filesystem::copy(std::filesystem::path(argv[1]).parent_path(), folder.path / "stage",
                              std::filesystem::copy_options::recursive);
        std::filesystem::remove(folder.path / "stage/stage.mp4");  // the export would ask whether to replace it
        const test::VirtualScreen screen(folder.path);
        const std::string stage = (folder.path / "stage" / std::filesystem::path(argv[1]).filename()).string();
        test::measure({screen, folder.path, stage});
    } catch (const std::exception& error) {
        fmt::print(stderr, "viewer_measure: {}\n", error.what());
        return 1;
    }
}
