#include "tools/train/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "base/text.h"
#include "tools/image_drawing.h"
#include "tools/report.h"
#include "tools/say.h"

namespace neuvv::tools {

namespace {

constexpr training::ColourRefinement kAllColours{true, true, true};
constexpr float kEqualGains = 0.02f;  // factors that differ less from 1 are not worth a line

std::string progress_text(const training::RigSearchProgress& now) {
    return fmt::format("rig {} eta {} | round {} | images moved by {:.2f} pixels, {:.2f} of them in the last round",
                       format_duration(now.elapsed_s), format_duration(now.eta_s), now.rounds, now.motion_px,
                       now.last_motion_px);
}

// The names of what is refined, with commas between them.
std::string names_of(const training::Refinement& what) {
    std::string names;
    const auto add = [&](bool wanted, const char* name) {
        if (wanted) names += names.empty() ? name : fmt::format(", {}", name);
    };
    add(what.colour.colour, "colour");
    add(what.colour.exposure, "exposure");
    add(what.colour.vignetting, "vignetting");
    add(what.poses, "poses");
    add(what.time, "time");
    return names.empty() ? "nothing" : names;
}

// What differs from a neutral camera, in words; nothing where the camera is neutral.
std::string colour_text(const training::CameraColours& colours, size_t camera) {
    std::string text;
    const glm::vec3 gains = training::gains(colours.values[camera]);
    if (glm::any(glm::greaterThan(glm::abs(gains - 1.0f), glm::vec3(kEqualGains))))
        text += fmt::format(", gains of R, G, B {:.3f} {:.3f} {:.3f}", gains.r, gains.g, gains.b);
    if (const size_t frames = colours.frames(); frames > 0) {
        const auto first = colours.exposures.values.begin() + static_cast<ptrdiff_t>(camera * frames);
        const auto [low, high] = std::minmax_element(first, first + static_cast<ptrdiff_t>(frames));
        if (std::max(*high, -*low) > kEqualGains)
            text += fmt::format(", exposures of {:.3f} to {:.3f}", std::exp(*low), std::exp(*high));
    }
    if (const std::vector<float>& vignettes = colours.vignettes.values; !vignettes.empty()) {
        const float corner = training::vignette_at({vignettes[2 * camera], vignettes[2 * camera + 1]}, 1);
        if (std::abs(corner - 1) > kEqualGains) text += fmt::format(", {:.3f} of the light at the corners", corner);
    }
    return text;
}

void print_colours(const training::CameraColours& colours, const std::vector<training::RigCamera>& cameras) {
    if (colours.empty()) return;
    bool agree = true;
    for (size_t i = 0; i < colours.cameras(); ++i) {
        const std::string text = colour_text(colours, i);
        if (!text.empty()) tell_if_possible("camera {}: {}\n", cameras[i].name, text.substr(2));
        agree &= text.empty();
    }
    if (agree) tell_if_possible("the colours of all cameras agree within {:.0f} %\n", 100 * kEqualGains);
}

constexpr double kStillPixels = 0.25;  // poses that move images less are not worth a line

void print_poses(const std::vector<training::RefinedPose>& poses, const std::vector<training::RigCamera>& cameras) {
    if (poses.empty()) return;
    bool still = true;
    for (size_t i = 0; i < poses.size(); ++i) {
        const training::PoseChange& change = poses[i].change;
        if (poses[i].motion_px < kStillPixels && !poses[i].at_bound) continue;
        const glm::dvec3 turn(change[training::kTurnX], change[training::kTurnY], change[training::kTurnZ]);
        const glm::dvec3 shift(change[training::kShiftX], change[training::kShiftY], change[training::kShiftZ]);
        tell_if_possible(
            "camera {}: its image moved by {:.2f} pixels (turned by {:.2f}°, shifted by {:.1f} mm, focal length "
            "{:+.2f} %){}\n",
            cameras[i].name, poses[i].motion_px, glm::degrees(glm::length(turn)), 1000 * glm::length(shift),
            100 * std::expm1(change[training::kZoom]),
            poses[i].at_bound ? ": as far as a pose may move; its calibration is probably wrong" : "");
        still = false;
    }
    if (still) tell_if_possible("the poses of all cameras stayed within {} pixels\n", kStillPixels);
}

void print_times(const training::RigChanges& changes, const std::vector<training::RigCamera>& cameras) {
    const std::vector<double>& frames_late = changes.frames_late;
    if (frames_late.empty()) return;
    const std::vector<bool> out = training::left_out(changes);
    bool agree = true;
    for (size_t i = 0; i < frames_late.size(); ++i) {
        if (i < changes.readout.size() && changes.readout[i] != 0) {
            agree = false;
            tell_if_possible(
                "camera {}: a rolling shutter, by {:+.2f} frames from its top row to the bottom one; its "
                "images {}\n",
                cameras[i].name, changes.readout[i],
                out[i] ? "were left out" : "were used all the same: too many cameras would be left out");
            if (out[i]) continue;
        }
        const auto whole = static_cast<int>(std::lround(frames_late[i]));
        const bool between = training::is_between_frames(frames_late[i]);
        if (whole == 0 && !between) continue;
        agree = false;
        tell_if_possible("camera {}: late by {:+.2f} frames; its images {}\n", cameras[i].name, frames_late[i],
                         out[i]    ? "lie between frames, and were left out"
                         : between ? "lie between frames, as those of many cameras do, and were used all the same"
                                   : fmt::format("were moved by {:+} frames", whole));
    }
    if (agree) tell_if_possible("no camera was found to be late, or to have a rolling shutter\n");
}

}  // namespace

Refine refine_of(const std::string& text) {
    Refine refine;
    const std::pair<const char*, bool*> known[] = {{"colour", &refine.what.colour.colour},
                                                   {"exposure", &refine.what.colour.exposure},
                                                   {"vignetting", &refine.what.colour.vignetting},
                                                   {"poses", &refine.what.poses},
                                                   {"time", &refine.what.time},
                                                   {"auto", &refine.automatic}};
    if (text.empty()) {
        refine.what.colour = {.colour = true, .exposure = true};  // clean rigs seem to have vignettes of up to 29 %
        refine.tries_colours = true;
    }
    if (text.empty() || text == "none") return refine;
    for (const std::string& name : split(text, ',')) {
        const auto found = std::ranges::find(known, name, [](const auto& one) { return one.first; });
        if (found == std::end(known))
            throw InputError("--refine", name, "is nothing that training can refine",
                             "write auto, none, or one or more of colour, exposure, vignetting, poses, time, with "
                             "commas between them");
        *found->second = true;
    }
    if (refine.automatic && text != "auto")
        throw InputError("--refine", text, "names others beside auto, which chooses by itself", "write auto alone");
    if (refine.what.poses && refine.what.time)
        throw InputError("--refine", text,
                         "asks for poses and time at once, but a late camera looks like one that is turned",
                         "write one of the two, or auto, which sees which of them it is");
    return refine;
}

std::optional<training::RigFindings> search_rig(const gpu::Device& device, const training::Dataset& dataset,
                                                training::TrainSettings settings, training::ColourRefinement colour,
                                                bool move_cameras) {
    settings.refine = colour;
    StatusLine line(true);
    bool said = false;
    auto found =
        training::search_rig(device, dataset, settings, move_cameras, [&](const training::RigSearchProgress& now) {
            if (!std::exchange(said, true))
                say("a draft looks for errors of the rig for {}; Ctrl-C ends it with what it has found\n",
                    now.most_s > 0 ? "at most " + format_duration(now.most_s)
                                   : "about " + format_duration(now.elapsed_s + now.eta_s));
            if (line.is_due()) line.print(progress_text(now));
            return !stop_requested();
        });
    line.end();
    return found;
}

bool correct_rig(const gpu::Device& device, const training::Dataset& dataset, const Refine& refine,
                 training::TrainSettings& settings) {
    const double began = seconds_now();
    const auto found = search_rig(device, dataset, settings, refine.automatic ? kAllColours : refine.what.colour,
                                  refine.automatic || refine.what.poses);
    if (!found && stop_requested()) return false;
    training::Refinement what = refine.what;
    if (found && refine.automatic) what = training::worthwhile(*found);
    if (!found || !found->whole)
        say("the draft ended before its end: {}\n", !found ? "nothing was found, and nothing is corrected"
                                                    : refine.automatic
                                                        ? "poses and times are not known well enough to be corrected"
                                                        : "what it found is not exact");
    if (refine.automatic) say("--refine auto: {}\n", names_of(what));
    settings.refine = what.colour;
    if (found && what.poses) settings.rig.poses = found->changes.poses;
    if (found && what.time)
        for (size_t i = 0; i < dataset.cameras.size(); ++i) {
            settings.rig.frames_late.push_back(training::is_late(*found, i) ? found->changes.frames_late[i] : 0);
            settings.rig.readout.push_back(training::is_rolling(*found, i) ? found->changes.readout[i] : 0);
        }
    if (settings.steps == 0) {
        if (settings.minutes == 0) settings.minutes = training::kDefaultMinutes;
        settings.minutes = std::max(settings.minutes - (seconds_now() - began) / 60, 0.01);
    }
    return true;
}

void print_corrections(const training::TrainProgress& last, const std::vector<training::RigCamera>& cameras) {
    print_colours(last.colours, cameras);
    print_poses(last.poses, cameras);
    print_times({{}, last.frames_late, last.readout}, cameras);
}

namespace {

// How late a camera is. Of one that seems to stand elsewhere, this is not known.
std::string late_text(const training::RigFindings& findings, size_t camera) {
    if (findings.late_by[camera] >= training::kMostDeviation) return "not known, too little moves";
    const std::string text =
        fmt::format("{:+.2f} ± {:.2f}", findings.changes.frames_late[camera], findings.late_by[camera]);
    return training::worthwhile(findings).poses ? text + " or moved" : text;
}

// Shutters that differ from those of the other cameras; what all have in common, the draft has, too.
void print_shutters(const training::RigFindings& findings, const std::vector<training::RigCamera>& cameras) {
    const char* doubt = !findings.whole                        ? ", if the draft was long enough"
                        : training::worthwhile(findings).poses ? ", or it stands elsewhere"
                                                               : "";
    bool agree = true, known = false;
    for (size_t i = 0; i < cameras.size(); ++i) {
        known = known || findings.late_by[i] < training::kMostDeviation;
        if (training::is_rolling(findings, i))
            tell("camera {}: a rolling shutter: its bottom row is {:+.2f} ± {:.2f} frames later than its top one{}\n",
                 cameras[i].name, findings.changes.readout[i], findings.roll_by[i], doubt);
        else if (findings.blur[i] > training::kWorthBlur)
            tell("camera {}: what moves is blurred: an exposure longer by about {:.1f} frames than that of most{}\n",
                 cameras[i].name, findings.blur[i], doubt);
        else
            continue;
        agree = false;
    }
    if (!known)
        tell("shutters are not known: too little moves\n");
    else if (agree)
        tell("no camera was found whose shutter rolls, or blurs, more than those of the others\n");
}

}  // namespace

void print_findings(const training::RigFindings& findings, const std::vector<training::RigCamera>& cameras) {
    const training::CameraColours& colours = findings.colours;
    tell("{:<14} {:>6} {:>7} {:>8} {:>8} {:>7}  {:<17} {:>8} {:>7}  {}\n", "camera", "dB", "off px", "turned",
         "shifted", "focal", "gains R G B", "exposure", "corner", "late, frames");
    for (size_t i = 0; i < cameras.size(); ++i) {
        const training::PoseChange& change = findings.changes.poses[i];
        const glm::dvec3 turn(change[training::kTurnX], change[training::kTurnY], change[training::kTurnZ]);
        const glm::dvec3 shift(change[training::kShiftX], change[training::kShiftY], change[training::kShiftZ]);
        const glm::vec3 gains = training::gains(colours.values[i]);
        tell(
            "{:<14} {:>6.2f} {:>7.2f} {:>7.2f}° {:>5.1f} mm {:>5.2f} %  {:.3f} {:.3f} {:.3f} {:>7.1f} % {:>7.3f}  {}\n",
            cameras[i].name, findings.psnr[i], findings.motion_px[i], glm::degrees(glm::length(turn)),
            1000 * glm::length(shift), 100 * std::expm1(change[training::kZoom]), gains.r, gains.g, gains.b,
            100 * training::exposure_error(colours, i), 1 - training::missing_at_corners(colours, i),
            late_text(findings, i));
    }
    print_shutters(findings, cameras);
    tell("worth correcting (neuvv train --refine auto): {}\n", names_of(training::worthwhile(findings)));
}

namespace {

constexpr Colour kPaper = {255, 255, 255}, kInk = {40, 40, 40}, kCalm = {90, 130, 190}, kOff = {230, 110, 0},
                 kRule = {210, 210, 210};
constexpr int kRow = 18, kColumn = 190, kNames = 130, kBar = 150, kTop = 34;  // pixels

// A column of the chart: a value for each camera, the value at the end of the longest bar, and that from which a
// correction is worth it.
struct Column {
    std::string title;
    std::vector<double> values;
    double longest, worth;
};

std::vector<Column> columns_of(const training::RigFindings& findings) {
    std::vector<Column> columns{{"OFF 0-2 PIXELS", {}, 2, training::kWorthPixels},
                                {"GAIN 0-20 PER CENT", {}, 0.2, training::kWorthGain},
                                {"EXPOSURE 0-20", {}, 0.2, training::kWorthExposure},
                                {"CORNERS 0-40", {}, 0.4, training::kWorthVignetting},
                                {"LATE 0-1 FRAME", {}, 1, training::kWorthFrames}};
    for (size_t i = 0; i < findings.motion_px.size(); ++i) {
        columns[0].values.push_back(findings.motion_px[i]);
        columns[1].values.push_back(training::largest_gain_error(findings.colours, i));
        columns[2].values.push_back(training::exposure_error(findings.colours, i));
        columns[3].values.push_back(std::abs(training::missing_at_corners(findings.colours, i)));
        const bool known = findings.late_by[i] < training::kMostDeviation;
        columns[4].values.push_back(known ? std::abs(findings.changes.frames_late[i]) : 0);
    }
    return columns;
}

void fill(media::Image& image, int left, int top, int width, int height, const Colour& colour) {
    for (int y = top; y < top + height; ++y)
        for (int x = left; x < left + width; ++x) set_pixel(image, x, y, colour);
}

}  // namespace

media::Image draw_findings(const training::RigFindings& findings, const std::vector<training::RigCamera>& cameras) {
    const std::vector<Column> columns = columns_of(findings);
    media::Image image(static_cast<uint32_t>(kNames + kColumn * static_cast<int>(columns.size())),
                       static_cast<uint32_t>(kTop + kRow * static_cast<int>(cameras.size()) + 8));
    for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
    fill(image, 0, 0, static_cast<int>(image.width), static_cast<int>(image.height), kPaper);
    for (size_t camera = 0; camera < cameras.size(); ++camera)
        draw_text(image, 6, kTop + kRow * static_cast<int>(camera) + 3, cameras[camera].name.substr(0, 14), kInk);
    for (size_t c = 0; c < columns.size(); ++c) {
        const Column& column = columns[c];
        const int left = kNames + kColumn * static_cast<int>(c);
        draw_text(image, left, 10, column.title, kInk);
        for (size_t camera = 0; camera < cameras.size(); ++camera) {
            const double value = std::clamp(column.values[camera] / column.longest, 0.0, 1.0);
            fill(image, left, kTop + kRow * static_cast<int>(camera) + 2, static_cast<int>(kBar * value), kRow - 6,
                 column.values[camera] > column.worth ? kOff : kCalm);
        }
        const int worth = left + static_cast<int>(kBar * column.worth / column.longest);
        draw_line(image, {worth, kTop - 4}, {worth, image.height - 6}, kRule);
    }
    return image;
}

}  // namespace neuvv::tools
