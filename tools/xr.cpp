// neuvv xr: shows clips and stages in a headset, where they can be edited.
#include <fmt/format.h>

#include <algorithm>

#include "tools/commands.h"
#include "tools/headset/headset.h"
#include "tools/headset/probe.h"
#include "tools/options.h"
#include "tools/results.h"
#include "xr/bindings.h"
#include "xr/body_tracking.h"
#include "xr/room.h"

namespace neuvv::tools {

namespace {

struct XrOptions {
    std::string file;
    headset::HeadsetOptions headset;
    std::string report;
    bool check = false, no_mask = false, no_depth = false, stereo = false;
    double refresh_hz = 0, inset = 0;
    std::optional<bool> far_levels;  // nothing: on
};

const char* yes_or_no(bool yes) {
    return yes ? "yes" : "no";
}

// The option that an extension makes work, to be added to what is said of it.
std::string option_of(std::string_view extension) {
    if (extension == XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME) return " (--refresh)";
    if (extension == XR_FB_PASSTHROUGH_EXTENSION_NAME) return " (--room)";
    if (extension == XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME) return " (--inset)";
    return "";
}

void print_extensions(const xr::Runtime& runtime, const std::vector<std::string>& idle) {
    fmt::print("\nVulkan: {}\n",
               runtime.has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME) ? "XR_KHR_vulkan_enable2" : "XR_KHR_vulkan_enable");
    for (const xr::OptionalExtension& one : xr::optional_extensions()) {
        if (one.is_controller) continue;  // print_controllers says which have bindings, and which is in hand
        const bool works = runtime.supports(one.name) && std::ranges::find(idle, one.name) == idle.end();
        fmt::print("{:3} {}: {}{}\n", yes_or_no(works), one.name,
                   works ? one.benefit + option_of(one.name) : one.fallback,
                   runtime.has(one.name) && !works ? " (the runtime has it, but not for this headset)" : "");
    }
}

void print_views(const xr::Runtime& runtime) {
    const auto print = [&](const char* what, uint32_t left, bool follows_gaze) {
        const VkExtent2D size = runtime.recommended_size(left, follows_gaze);
        fmt::print("{}: {}x{} recommended\n", what, size.width, size.height);
    };
    const VkExtent2D most = runtime.max_image_size();
    print(runtime.has_narrow_views() ? "wide view of each eye" : "view of each eye", 0, false);
    if (runtime.has_narrow_views()) print("narrow view of each eye, in the centre", xr::kEyes, false);
    if (runtime.narrow_views_follow_gaze()) {
        print("wide view while the eyes are tracked", 0, true);
        print("narrow view while the eyes are tracked, where they look", xr::kEyes, true);
    }
    fmt::print("images: {}x{} at most\n", most.width, most.height);
}

void print_controllers(const xr::Runtime& runtime, const headset::HeadsetProbe& probe) {
    for (const int hand : {xr::kLeft, xr::kRight}) {
        const std::string& name = probe.controllers[hand];
        fmt::print("{} hand: {}{}\n", hand == xr::kLeft ? "left" : "right",
                   !name.empty()     ? name
                   : probe.had_focus ? "no controller (is it switched on?)"
                                     : "unknown, as the runtime has not given this program the focus: put the "
                                       "headset on, close its menu and try again",
                   name.empty() || probe.are_located[hand] ? "" : ", but where it is is not known");
    }
    if (probe.bare_hands[xr::kLeft] || probe.bare_hands[xr::kRight])
        fmt::print("bare hands: seen\n");
    else if (runtime.supports(XR_EXT_HAND_TRACKING_EXTENSION_NAME))
        fmt::print("bare hands: none seen now\n");
    if (!probe.trackers.empty()) fmt::print("worn trackers: {}\n", fmt::join(probe.trackers, ", "));
    fmt::print("controllers with bindings:");
    for (const xr::ControllerProfile& profile : xr::controller_profiles())
        if (!profile.extension || runtime.has(profile.extension)) fmt::print(" {};", profile.title);
    fmt::print(" others as their runtime translates them\n");
}

// Prints what the runtime and the headset offer, and what is missing.
void check_headset(const std::string& choice, xr::ViewChoice views) {
    xr::Runtime runtime(views);
    fmt::print("runtime: {}\nheadset: {}, {}\n", runtime.name(), runtime.headset(),
               runtime.tracks_position() ? "position and orientation are tracked" : "only its orientation is tracked");
    print_views(runtime);
    std::vector<std::string> modes;
    for (const XrEnvironmentBlendMode mode : runtime.blend_modes()) modes.emplace_back(xr::blend_mode_name(mode));
    fmt::print("blend modes: {}\nyour own room: {}\n", fmt::join(modes, ", "),
               xr::title_of(xr::best_room_view(runtime)));
    fmt::print("body: {}\n", xr::title_of(xr::best_body_source(runtime)));
    const gpu::Device device(choice, gpu::Validation::kOff, runtime.device_extensions(), runtime.device_maker());
    fmt::print("device: {} ({})\n", device.summary().name, device.summary().driver);
    const headset::HeadsetProbe probe = headset::probe_headset(runtime, device);
    fmt::print("images: {}\nfloor: {}\n", probe.images, probe.floor);
    if (!probe.refresh_rates.empty()) fmt::print("refresh rates: {} Hz\n", fmt::join(probe.refresh_rates, ", "));
    print_controllers(runtime, probe);
    print_extensions(runtime, probe.idle);
    fmt::print("\nready: `neuvv xr STAGE` shows a stage there\n");
}

}  // namespace

void add_xr(Command app, CommonOptions& common) {
    auto options = std::make_shared<XrOptions>();
    headset::HeadsetOptions& headset = options->headset;
    Command verb = app.add_verb("xr", "Watch and edit clips and stages in a headset (OpenXR)");
    verb.add_option("file", options->file,
                    "A stage (.gltf, .glb), a clip (.nvv, or the .npz of a PlenOctree), or a folder of clips");
    verb.add_flag("--check", options->check,
                  "Say what the runtime and its headset offer, and what is missing; no file is looked at");
    verb.add_flag("--mirror", headset.mirror, "A window that shows what the left eye sees");
    verb.add_flag("--play", headset.play, "Play from the start");
    verb.add_flag(
        "--room", headset.room,
        "Show your own room in place of the set, where the headset can; performers' shadows fall on its floor");
    verb.add_option("--trainee", headset.trainee,
                    "Be coached by the first performer that has a skeleton, by this motion instead of the wearer's: "
                    "vmc[:[HOST:]PORT], udp:[HOST:]PORT, or a recorded file");
    verb.add_option("--scale", headset.quality.scale,
                    "Rays a pixel along each side; otherwise as many as the refresh rate allows")
        .number_between(0.2, 1);
    verb.add_option("--inset", options->inset,
                    "Only this share of each eye's side gets all rays, where you look (or in the centre, where the "
                    "headset does not say); beside it half of them")
        .number_between(0.1, 0.95);
    verb.add_flag("--stereo", options->stereo,
                  "One view for each eye, even where the headset has a narrow one with more pixels besides, in which "
                  "case there is no --inset");
    verb.add_option("--refresh", options->refresh_hz, "Hz of the display, or the nearest rate that it knows")
        .number_between(1, 1000);
    add_far_levels_option(verb, options->far_levels);
    verb.add_flag("--no-mask", options->no_mask, "Draw what no lens shows, too");
    verb.add_flag("--no-depth", options->no_depth, "Do not give depth to the compositor");
    verb.add_flag("--recover", headset.recover, "Take unsaved edits that an earlier run left behind");
    verb.add_option("--report", options->report,
                    "At the end, write into this JSON file what was seen last and where the panel's buttons are, for "
                    "programs that drive it");
    verb.add_flag("--validate", headset.validate, "With Vulkan's validation layers");
    verb.footer(
        {"Controls (xr/README.md has an image, and what they are on other controllers):\n"
         "  trigger selects, presses the panel, paints; grip holds, both grips scale\n"
         "  left stick up shows an arc, and lets you stand where it ends; sideways steps through time; right stick "
         "sideways turns you, up and down is the speed\n"
         "  A plays, B duplicates, X undoes, Y or the menu button shows the panel with all else\n"
         "  the panel's page Coach begins a session with the selected performer: what you do otherwise turns red\n\n"
         "Examples:\n"
         "  neuvv xr --check\n"
         "  neuvv xr demo/stage.gltf --mirror\n"
         "  neuvv xr demo/stage.gltf --trainee vmc"});
    verb.callback([options, &common] {
        const xr::ViewChoice views = options->stereo ? xr::ViewChoice::kStereo : xr::ViewChoice::kAsOffered;
        if (options->check) return check_headset(common.device, views);
        if (options->file.empty()) throw InputError("xr", "", "there is nothing to show", "name a stage or a clip");
        expect_there(options->file);
        if (!options->report.empty()) prepare_live_file("--report", options->report, kJsonEnding);
        headset::HeadsetOptions& settings = options->headset;
        settings.file = options->file;
        settings.device = common.device;
        settings.report = options->report;
        settings.views = views;
        settings.quality.far_levels = options->far_levels.value_or(true);
        settings.quality.mask = !options->no_mask;
        settings.quality.depth = !options->no_depth;
        settings.quality.keep_images = settings.mirror;
        if (options->inset > 0) settings.quality.inset = options->inset;
        if (options->refresh_hz > 0) settings.refresh_hz = options->refresh_hz;
        headset::run_headset(settings);
    });
}

}  // namespace neuvv::tools
