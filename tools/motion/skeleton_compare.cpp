// neuvv skeleton compare and follow: what a trainee does otherwise than a trainer.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/line_reader.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/text.h"
#include "motion/compare/compare.h"
#include "motion/live/live.h"
#include "motion/live/pose_line.h"
#include "motion/live/pose_source.h"
#include "motion/skeleton/skeleton_file.h"
#include "tools/motion/motion_page.h"
#include "tools/motion/skeleton_verbs.h"
#include "tools/remedies.h"
#include "tools/results.h"
#include "tools/say.h"

namespace neuvv::tools {

std::vector<bool> counted_limbs(const std::string& left_out) {
    std::vector<bool> counted(motion::kLimbs, true);
    if (left_out.empty()) return counted;
    for (const std::string& name : split(left_out, ',')) {
        const auto limb = std::ranges::find(motion::kLimbNames, name);
        if (limb == motion::kLimbNames.end())
            throw InputError("--leave-out", name, "is no limb",
                             "write trunk, head, right arm, left arm, right leg or left leg");
        counted[static_cast<size_t>(limb - motion::kLimbNames.begin())] = false;
    }
    return counted;
}

nlohmann::ordered_json comparison_json(const motion::Comparison& comparison) {
    constexpr const char* kKinds[] = {"off", "late", "mirrored"};
    constexpr const char* kAmounts[] = {"degrees", "seconds", "degrees"};
    nlohmann::ordered_json limbs, mistakes = nlohmann::ordered_json::array();
    for (size_t limb = 0; limb < motion::kLimbs; ++limb)
        if (comparison.limb_scores[limb] >= 0) limbs[motion::kLimbNames[limb]] = comparison.limb_scores[limb];
    for (const motion::Mistake& mistake : comparison.mistakes) {
        const auto kind = static_cast<size_t>(mistake.kind);
        mistakes.push_back({{"limb", motion::kLimbNames[motion::index_of(mistake.limb)]},
                            {"kind", kKinds[kind]},
                            {kAmounts[kind], mistake.amount},
                            {"from_s", mistake.first_s},
                            {"to_s", mistake.last_s}});
    }
    return {{"score", comparison.score}, {"limbs", limbs}, {"mistakes", mistakes}};
}

void print_comparison(const motion::Comparison& comparison) {
    tell("score {:.0f} of 100\n", comparison.score);
    for (size_t limb = 0; limb < motion::kLimbs; ++limb)
        if (comparison.limb_scores[limb] >= 0)
            tell("  {:<10} {:3.0f}\n", motion::kLimbNames[limb], comparison.limb_scores[limb]);
        else
            tell("  {:<10}   -  not compared\n", motion::kLimbNames[limb]);
    for (const motion::Mistake& mistake : comparison.mistakes) tell("{}\n", text_of(mistake));
}

namespace {

struct CompareOptions {
    std::string trainer, trainee, html, csv, leave_out;
    bool json = false;
    motion::CompareOptions compare;
};

void run_compare(CompareOptions& options) {
    if (!options.html.empty()) prepare_result("--html", options.html, kHtmlEndings);
    if (!options.csv.empty()) prepare_result("--csv", options.csv, kCsvEnding);
    options.compare.counted = counted_limbs(options.leave_out);
    const motion::SkeletonClip trainer = read_motion(options.trainer), trainee = read_motion(options.trainee);
    const motion::Comparison found = motion::compare(trainer, trainee, options.compare);
    if (!options.html.empty())
        write_text_file(options.html, motion_page({options.trainer, options.trainee}, trainer, trainee, found,
                                                  options.compare.tolerances));
    if (!options.csv.empty()) write_text_file(options.csv, motion_csv(found));
    for (const std::string& written : {options.html, options.csv})
        if (!written.empty()) say("wrote {}\n", written);
    if (options.json) {
        tell("{}", json_text(comparison_json(found)));
        return;
    }
    print_comparison(found);
}

struct FollowOptions {
    std::string trainer, stream = "-", leave_out;
    motion::CompareOptions compare;
};

// Says what changed since the last feedback: which limbs turned red, and which are right again.
void print_changes(double time_s, const motion::Feedback& feedback, std::array<bool, motion::kLimbs>& wrong) {
    for (size_t i = 0; i < motion::kLimbs; ++i) {
        const motion::LimbFeedback& limb = feedback.limbs[i];
        if (limb.wrong == wrong[i]) continue;
        wrong[i] = limb.wrong;
        const std::string text = !limb.wrong       ? "right again"
                                 : limb.late_s > 0 ? fmt::format("{:.1f} s late", limb.late_s)
                                 : limb.late_s < 0 ? fmt::format("{:.1f} s early", -limb.late_s)
                                                   : fmt::format("{:.0f}° off", limb.error_deg);
        tell("{:7.2f} s  {}: {}\n", time_s, motion::kLimbNames[i], text);
        std::fflush(stdout);
    }
}

// The comparison with the first pose at the clip's beginning.
class Follower {
  public:
    Follower(const motion::SkeletonClip& trainer, const motion::CompareOptions& options)
        : live_(trainer, options), end_s_(static_cast<double>(trainer.frames.size() - 1) / trainer.fps) {}

    bool begun() const { return begin_s_.has_value(); }
    // Whether the clip has ended by this time of the poses' clock.
    bool ended(double time_s) const { return begin_s_ && time_s - *begin_s_ > end_s_; }
    void add(const motion::TimedPose& pose) {
        if (!begin_s_) begin_s_ = pose.time_s;
        const double time_s = pose.time_s - *begin_s_;
        print_changes(time_s, live_.add(pose.pose, time_s, time_s), wrong_);
    }
    void print_score() const {
        const auto known = [](const motion::LimbFeedback& limb) { return limb.error_deg >= 0; };
        if (live_.feedback().score < 0)
            tell("no score: {}\n", std::ranges::any_of(live_.feedback().limbs, known) ? "the poses are too few"
                                                                                      : "no limb was measured in both");
        else
            tell("score {:.0f} of 100\n", live_.feedback().score);
    }

  private:
    motion::LiveComparison live_;
    double end_s_;
    std::optional<double> begin_s_;
    std::array<bool, motion::kLimbs> wrong_{};
};

// Poses of a file or of stdin, by their own times and as fast as they come. Returns how many lines were left out.
size_t follow_lines(LineReader& lines, const std::string& name, Follower& follower) {
    constexpr int kWait_ms = 100;
    motion::FirstPerson person;
    std::string line;
    size_t number = 0, bad = 0;
    while (!stop_requested()) {
        const LineReader::Result result = lines.next(line, kWait_ms);
        if (result == LineReader::Result::kEnd) break;
        if (result == LineReader::Result::kNothing) continue;
        ++number;
        if (line.empty()) continue;
        try {
            const std::string place = fmt::format("{}: line {}", name, number);
            const motion::TimedPose pose = motion::read_pose_line(line, place);
            person.expect(pose, place);
            if (follower.ended(pose.time_s)) break;
            follower.add(pose);
        } catch (const InputError& error) {  // a stream goes on
            if (++bad == 1) say("{}; it is left out\n", message_of(error));
        }
    }
    return bad;
}

// Poses that come to a port, by the time at which they come. Returns how many packets were left out.
size_t follow_port(motion::PoseSource& source, Follower& follower) {
    say("listens: {}; {}\n", source.name(), source.advice());
    const auto start = std::chrono::steady_clock::now();
    bool said = false;
    while (!stop_requested()) {
        const double now_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const std::optional<motion::TimedPose> pose = source.newest(now_s);
        if (follower.ended(now_s)) break;
        if (pose) follower.add(*pose);
        if (const motion::PoseSourceState state = source.state(); !said && state.left_out > 0) {
            say("{}; it is left out\n", state.first_error);
            said = true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return source.state().left_out;
}

void run_follow(FollowOptions& options) {
    options.compare.counted = counted_limbs(options.leave_out);
    const motion::SkeletonClip trainer = read_motion(options.trainer);
    const std::string name = options.stream == "-" ? "stdin" : options.stream;
    Follower follower(trainer, options.compare);
    size_t left_out = 0;
    std::string advice = "write one pose a line, as engine/motion/README.md says";
    catch_stop_signals();
    if (motion::is_port_address(options.stream)) {
        const std::unique_ptr<motion::PoseSource> source = motion::open_pose_source(options.stream);
        advice = source->advice();
        left_out = follow_port(*source, follower);
    } else if (options.stream == "-") {
        LineReader lines(kStandardInput, motion::kLongestPoseLine);
        left_out = follow_lines(lines, name, follower);
    } else {
        LineReader lines(std::filesystem::path(options.stream), motion::kLongestPoseLine);
        left_out = follow_lines(lines, name, follower);
    }
    if (!follower.begun()) throw InputError(name, "", "has no pose", advice);
    if (left_out > 1)
        say("{} {} were left out\n", left_out, motion::is_port_address(options.stream) ? "packets" : "lines");
    follower.print_score();
}

}  // namespace

void add_skeleton_compare(Command group) {
    Command verb = group.add_verb("compare", "Say what a trainee does otherwise than a trainer");
    const auto options = std::make_shared<CompareOptions>();
    verb.add_option("TRAINER", options->trainer, "a .skeleton.glb, an animated .glb or .gltf, a .bvh or a .trc")
        .required();
    verb.add_option("TRAINEE", options->trainee, "likewise; elsewhere, turned otherwise, of another size is no mistake")
        .required();
    verb.add_option("--html", options->html, "a report with curves and stick figures");
    verb.add_option("--csv", options->csv, "each limb's error, frame by frame");
    verb.add_flag("--json", options->json, "print JSON");
    verb.add_option("--leave-out", options->leave_out, "limbs that do not count: \"head,left arm\"");
    verb.add_option("--band", options->compare.band_s, "seconds that the trainee may be early or late")
        .number_between(0.1, 60)
        .show_default();
    verb.footer(
        {"\nExamples:\n"
         "  neuvv skeleton compare work/performer.skeleton.glb work/take.bvh\n"
         "  neuvv skeleton compare work/performer.skeleton.glb work/take.trc --html work/report.html"});
    verb.callback([options] { run_compare(*options); });
}

void add_skeleton_follow(Command group) {
    Command verb =
        group.add_verb("follow", "Say while somebody performs what is otherwise: poses come as they are tracked");
    const auto options = std::make_shared<FollowOptions>();
    verb.add_option("TRAINER", options->trainer, "a .skeleton.glb, an animated .glb or .gltf, a .bvh or a .trc")
        .required();
    verb.add_option("STREAM", options->stream, "a file of poses; - is stdin; or a port: vmc, vmc:PORT, udp:PORT")
        .show_default();
    verb.add_option("--leave-out", options->leave_out, "limbs that do not count: \"head,left arm\"");
    verb.footer(
        {"\nA pose is {\"time\": 1.25, \"joints\": {\"left_wrist\": [x, y, z], \"nose\": [x, y, z, confidence]}}, a "
         "line\n"
         "each; the first one is at the clip's beginning. A line that is no pose is left out, and the first such line\n"
         "is said.\n\n"
         "Live streams are compared by the time at which poses come, until the clip ends or Ctrl-C:\n"
         "  vmc, vmc:PORT, vmc:HOST:PORT   the VMC protocol, as Virtual Motion Capture or VSeeFace send it;\n"
         "                                 port 39539 where none is named\n"
         "  udp:PORT, udp:HOST:PORT        poses as above, a UDP packet each\n"
         "Only this machine may send, unless HOST is its address in a network, or 0.0.0.0 for all of them.\n\n"
         "Examples:\n"
         "  neuvv skeleton follow work/performer.skeleton.glb work/take.jsonl\n"
         "  body-tracker --json | neuvv skeleton follow work/performer.skeleton.glb\n"
         "  neuvv skeleton follow work/performer.skeleton.glb vmc"});
    verb.callback([options] { run_follow(*options); });
}

}  // namespace neuvv::tools
