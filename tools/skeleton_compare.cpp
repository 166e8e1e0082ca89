// neuvv skeleton compare and follow: what a trainee does otherwise than a trainer.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/text.h"
#include "motion/compare.h"
#include "motion/live.h"
#include "motion/pose_line.h"
#include "motion/skeleton_file.h"
#include "tools/motion_page.h"
#include "tools/skeleton_verbs.h"

namespace neuvv::tools {

namespace {

struct CompareOptions {
    std::string trainer, trainee, html, csv, leave_out;
    bool json = false;
    motion::CompareOptions compare;
};

// The limbs that are compared, without those of a list "head,left arm".
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

nlohmann::ordered_json json_of(const motion::Comparison& comparison) {
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

void run_compare(CompareOptions& options) {
    if (!options.html.empty()) prepare_output_file("--html", options.html);
    if (!options.csv.empty()) prepare_output_file("--csv", options.csv);
    options.compare.counted = counted_limbs(options.leave_out);
    const motion::SkeletonClip trainer = motion::read_skeleton(options.trainer);
    const motion::SkeletonClip trainee = motion::read_skeleton(options.trainee);
    const motion::Comparison found = motion::compare(trainer, trainee, options.compare);
    if (!options.html.empty())
        write_text_file(options.html, motion_page({options.trainer, options.trainee}, trainer, trainee, found,
                                                  options.compare.tolerances));
    if (!options.csv.empty()) write_text_file(options.csv, motion_csv(found));
    if (options.json) {
        fmt::print("{}", json_text(json_of(found)));
        return;
    }
    fmt::print("score {:.0f} of 100\n", found.score);
    for (size_t limb = 0; limb < motion::kLimbs; ++limb)
        if (found.limb_scores[limb] >= 0)
            fmt::print("  {:<10} {:3.0f}\n", motion::kLimbNames[limb], found.limb_scores[limb]);
    for (const motion::Mistake& mistake : found.mistakes) fmt::print("{}\n", text_of(mistake));
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
        fmt::print("{:7.2f} s  {}: {}\n", time_s, motion::kLimbNames[i], text);
        std::fflush(stdout);
    }
}

// The next line, without its end, of which no more is kept than a pose may have; false at the end of the stream.
bool next_line(std::istream& stream, std::string& line) {
    line.clear();
    for (int c = stream.get(); c != EOF && c != '\n'; c = stream.get())
        if (line.size() <= motion::kLongestPoseLine) line += static_cast<char>(c);
    return stream.good() || !line.empty();
}

void run_follow(FollowOptions& options) {
    options.compare.counted = counted_limbs(options.leave_out);
    const motion::SkeletonClip trainer = motion::read_skeleton(options.trainer);
    const std::string name = options.stream == "-" ? "stdin" : options.stream;
    std::ifstream file;
    if (options.stream != "-") {
        file.open(options.stream);
        if (!file) throw InputError(name, "", "cannot be read", "name a file of poses, or - for stdin");
    }
    std::istream& lines = options.stream == "-" ? std::cin : file;
    motion::LiveComparison live(trainer, options.compare);
    std::array<bool, motion::kLimbs> wrong{};
    const double end_s = static_cast<double>(trainer.frames.size() - 1) / trainer.fps;
    std::optional<double> begin_s;
    std::string line;
    size_t number = 0, bad = 0;
    catch_stop_signals();
    while (!stop_requested() && next_line(lines, line)) {
        ++number;
        if (line.empty()) continue;
        try {
            const motion::TimedPose pose = motion::read_pose_line(line, fmt::format("{}: line {}", name, number));
            if (!begin_s) begin_s = pose.time_s;
            const double time_s = pose.time_s - *begin_s;
            if (time_s > end_s) break;
            print_changes(time_s, live.add(pose.pose, time_s, time_s), wrong);
        } catch (const InputError& error) {  // a stream goes on
            if (++bad == 1) fmt::print(stderr, "{}; it is left out\n", error.what());
        }
    }
    if (!begin_s) throw InputError(name, "", "has no pose", "write one pose a line, as engine/motion/README.md says");
    if (bad > 1) fmt::print(stderr, "{} lines were left out\n", bad);
    if (live.feedback().score < 0)
        fmt::print("no limb was measured in both\n");
    else
        fmt::print("score {:.0f} of 100\n", live.feedback().score);
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
         "  neuvv skeleton compare build/performer.skeleton.glb build/take.bvh\n"
         "  neuvv skeleton compare build/performer.skeleton.glb build/take.trc --html build/report.html"});
    verb.callback([options] { run_compare(*options); });
}

void add_skeleton_follow(Command group) {
    Command verb =
        group.add_verb("follow", "Say while somebody performs what is otherwise: poses come as lines of JSON");
    const auto options = std::make_shared<FollowOptions>();
    verb.add_option("TRAINER", options->trainer, "a .skeleton.glb, an animated .glb or .gltf, a .bvh or a .trc")
        .required();
    verb.add_option("STREAM", options->stream, "a file of poses; - is stdin").show_default();
    verb.add_option("--leave-out", options->leave_out, "limbs that do not count: \"head,left arm\"");
    verb.footer(
        {"\nA pose is {\"time\": 1.25, \"joints\": {\"left_wrist\": [x, y, z], \"nose\": [x, y, z, confidence]}}, a "
         "line\n"
         "each; the first one is at the clip's beginning. A line that is no pose is left out, and the first such line\n"
         "is said.\n\n"
         "Examples:\n"
         "  neuvv skeleton follow build/performer.skeleton.glb build/take.jsonl\n"
         "  body-tracker --json | neuvv skeleton follow build/performer.skeleton.glb"});
    verb.callback([options] { run_follow(*options); });
}

}  // namespace neuvv::tools
