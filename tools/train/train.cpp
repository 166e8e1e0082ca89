// neuvv train: trains a volumetric video from a data set.
#include <fmt/format.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "gpu/device.h"
#include "media/sound.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "tools/train/mpi.h"
#include "tools/train/refine.h"
#include "tools/train/replacement.h"
#include "tools/train/train_run.h"
#include "training/mattes/surroundings.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"
#include "training/run/schedule.h"
#include "training/tree/camera_check.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_index.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::tools {

namespace {

// Throws InputError where one of the files could not be written, or is not named as such a file. A run that is resumed
// goes on with them.
void prepare_live_outputs(const LiveOptions& live, bool resume) {
    const auto prepare = [&](const char* option, const std::filesystem::path& file, std::string_view ending) {
        if (file.empty()) return;
        expect_no_input(option, file);
        resume ? prepare_live_file(option, file, {ending}) : prepare_result(option, file, {ending});
    };
    prepare("--preview", live.preview, ".png");
    prepare("--metrics", live.metrics, ".jsonl");
}

// Whether the output is a segmented clip.
bool is_in_segments(const TrainOptions& options) {
    return !options.segment.empty() ||
           ((options.settings.resume || options.is_part()) && voctree::is_segmented(options.output));
}

// Throws InputError, before any work is done, where the result could not be written.
void prepare_output(const TrainOptions& options, const Ranks& ranks) {
    const std::filesystem::path& output = options.output;
    if (output.extension() != ".nvv")
        throw InputError("--output", output.string(), "is no name of an .nvv file", "write for instance scene.nvv");
    const bool folder = std::filesystem::is_directory(output);
    if (!is_in_segments(options)) {
        if (folder)
            throw InputError("--output", output.string(), "is a folder, of a segmented clip for instance",
                             "choose another name, or give --segment");
        return prepare_output_file("--output", output);
    }
    const bool in_use = folder ? !std::filesystem::is_empty(output) : std::filesystem::exists(output);
    if (ranks.is_first() && in_use && !voctree::is_segmented(output))  // the others may meet what the first writes
        throw InputError("--output", output.string(), "is there, and is no segmented clip",
                         "remove it, or choose another name");
    prepare_output_folder("--output", output);
}

// Throws InputError for combinations of options that make no sense.
void expect_compatible(const TrainOptions& options, const Ranks& ranks) {
    const Refine refine = refine_of(options.refine);
    optional_parts_of(options.leave_out);
    if (refine.needs_search() && options.init == "psi")
        throw InputError("--refine", options.refine, "cannot be combined with --init psi, but for colours",
                         "leave out one of the two");
    if (options.is_part() && !voctree::is_segmented(options.output))
        throw InputError("--from, --to", "", "train a part of a clip in segments again, which OUTPUT is not",
                         "leave them out, or train the whole clip with --segment first");
    if (options.is_part() && options.plan)
        throw InputError("--plan", "", "is for whole clips", "leave out --from and --to");
    if (!is_in_segments(options)) {
        if (options.plan) throw InputError("--plan", "", "is for clips in segments", "give --segment, or leave it out");
        if (ranks.count > 1 && (refine.is_asked() || options.init != "hull"))
            throw InputError("--refine, --init", "", "are not for several processes that train one tree",
                             "leave them out, or start one process");
        return;
    }
    if (options.is_part() && refine.needs_search())
        throw InputError("--refine", options.refine, "is decided once for all segments of a clip, but for colours",
                         "leave it out: a part corrects what the clip does");
}

[[noreturn]] void throw_taken(const std::filesystem::path& output) {
    const std::optional<training::ClaimState> claim = training::claim_of(output);
    throw InputError("--output", output.string(),
                     fmt::format("is being trained by {}", claim ? claim->owner : "another process"),
                     "wait for that, or choose another name; a clip in segments can be helped: --resume");
}

// The claim on a file; nothing, with a warning, where its file system has no locks.
std::optional<training::RunClaim> claim_file(const std::filesystem::path& output) {
    std::optional<training::RunClaim> claim;
    try {
        claim = training::RunClaim::take(output);
    } catch (const RuntimeFailure& failure) {
        say("nobody is kept from training into the same file: {}\n", message_of(failure));
        return std::nullopt;
    }
    if (!claim) throw_taken(output);
    return claim;
}

// When the state of a tree was written; the least time where there is none, and of a clip in segments.
std::filesystem::file_time_type state_written_at(const TrainOptions& options) {
    std::error_code ignored;
    return std::filesystem::last_write_time(training::state_path(options.output), ignored);
}

// Trains on a device, which is made anew once where it is lost; `train` then goes on from the files that are there.
void train_on(const std::string& name, TrainOptions& options, const std::function<void(const gpu::Device&)>& train) {
    const std::filesystem::file_time_type before = state_written_at(options);
    for (bool is_new = false;; is_new = true) {
        try {
            return train(gpu::Device(name));
        } catch (const gpu::VulkanError& error) {
            if (!error.device_lost()) throw;
            const std::string& output = options.output.string();
            if (is_new || options.settings.team.size > 1 || stop_requested())
                throw RuntimeFailure(
                    fmt::format("{}: {}; look at the driver's messages (dmesg), or choose another device "
                                "by --device; --resume goes on from the last checkpoint",
                                output, message_of(error)));
            say("\n{}: {}; the device is made anew\n", output, message_of(error));
        }
        // What a run has written is whole: it goes on, and one that had written nothing begins anew.
        options.settings.resume = options.settings.resume || state_written_at(options) != before;
    }
}

// Begins the clip without training it.
void run_plan(TrainOptions& options, const training::Rig& rig, const SegmentPlan& plan, const CommonOptions& common) {
    if (refine_of(options.refine).needs_search()) {
        if (!correct_clip(gpu::Device(common.device), options, rig, plan))
            throw RuntimeFailure("stopped before the clip was planned");
        expect_nobody_trains(options, plan);
    }
    begin_segments(options, plan);
    tell_if_possible(
        "planned {}: {} frames in {} segments; the same command with --resume in place of --plan trains them\n",
        options.clip().string(), plan.frames(), plan.segments.size());
}

// Of the first rank, which begins the clip: nobody else trains it from now on.
training::RunClaim claim_clip(const TrainOptions& options) {
    std::optional<training::RunClaim> clip = training::RunClaim::take(options.clip());
    if (!clip) throw_taken(options.clip());
    if (!options.replaces.empty()) begin_replacement(options);
    std::filesystem::remove(job_file(options.clip()));
    return std::move(*clip);
}

// `begun` is called once nobody else trains the clip.
void run_in_segments(TrainOptions& options, const training::Rig& rig, const Ranks& ranks, const CommonOptions& common,
                     const std::function<void()>& begun) {
    std::optional<training::RunClaim> clip;  // of the process that begins it, so that nobody else does
    SegmentPlan plan;
    const bool begins = !options.settings.resume;
    if (begins && !ranks.is_first()) {
        const std::filesystem::path place = place_of_first_rank(options.output, ranks);
        if (place.empty()) return;
        if (place != options.output) options.replaces = std::exchange(options.output, place);
    }
    plan = plan_segments(options, rig);
    if (begins && ranks.is_first()) {
        clip = claim_clip(options);
        expect_nobody_trains(options, plan);
    }
    begun();
    if (options.plan) {
        if (ranks.is_first()) run_plan(options, rig, plan, common);
        return;
    }
    train_on(device_of_rank(ranks, common.device), options, [&](const gpu::Device& device) {
        say("training on {}\n", device.summary().name);
        train_segments(device, options, rig, plan, ranks);
    });
}

// Ranks of one machine share the memory that images may take.
void share_memory(TrainOptions& options, const Ranks& ranks) {
    if (options.image_gigabytes <= 0 && ranks.on_machine > 1)
        options.image_gigabytes = 1e-9 * static_cast<double>(training::image_budget()) / ranks.on_machine;
}

// Of a long clip as one tree, many frames have to share each basis.
void advise_segments(const TrainOptions& options, const training::Rig& rig) {
    const size_t frames = training::times_of(rig).size();
    if (frames > 4 * size_t{options.settings.shape.bases} && !options.settings.resume)
        say("{} frames share {} temporal bases; `--segment auto` gives each second a tree of its own\n", frames,
            options.settings.shape.bases);
}

// Nothing where there is none. Read at once, so that a file without sound is known before the training.
std::optional<media::Sound> read_audio(const TrainOptions& options) {
    std::error_code error;
    if (options.audio.empty() || std::filesystem::equivalent(options.audio, voctree::sound_file(options.clip()), error))
        return std::nullopt;
    media::expect_sound_encoder();
    if (!options.settings.resume) prepare_result("--audio", voctree::sound_file(options.clip()));
    return media::read_sound(options.audio);
}

// What the user may still want to know of a run that has ended: where the clip is, and what else lies there.
void conclude(const TrainOptions& options, bool complete) {
    if (!options.replaces.empty() && !complete) {
        tell_if_possible("{} stays as it is until the new one is whole\n", options.replaces.string());
        return;
    }
    if (!options.replaces.empty()) {
        finish_replacement(options);
        tell_if_possible("{} is replaced by it\n", options.replaces.string());
    }
    const std::filesystem::path state = training::state_path(options.clip());
    std::error_code error;
    const uint64_t bytes = std::filesystem::file_size(state, error);
    if (complete && !error)
        tell_if_possible("{}, {}, is only for --resume with a larger budget: remove it when the clip is good\n",
                         state.string(), size_text(bytes));
}

void run_train(TrainOptions options, const CommonOptions& common) {
    const Ranks ranks = ranks_of_environment();
    share_memory(options, ranks);
    expect_compatible(options, ranks);
    prepare_output(options, ranks);
    if (ranks.is_first()) prepare_live_outputs(options.live, options.settings.resume);  // which the others do not have
    const bool in_segments = is_in_segments(options);
    if (ranks.is_first() || options.settings.resume) {
        const std::filesystem::path place = training_place(options, in_segments, common.overwrite);
        if (place != options.output) options.replaces = std::exchange(options.output, place);
    }
    catch_stop_signals(kEndless);
    catch_batch_signals();
    training::Rig rig = training::read_rig(options.dataset, training::Split::kTrain, options.format, options.holdout);
    training::check_cameras(rig);
    if (ranks.is_first()) say_remarks(rig.remarks);
    const std::optional<media::Sound> audio = ranks.is_first() ? read_audio(options) : std::nullopt;
    const auto begun = [&] {
        // Not before the output, the plan and other options were found to be right.
        if (ranks.is_first() && !options.surroundings && !options.settings.resume)
            say_remarks(training::advice_on(rig));
        if (audio) media::write_sound(voctree::sound_file(options.output), *audio);
    };
    if (in_segments) return run_in_segments(options, rig, ranks, common, begun);
    if (ranks.is_first() && !options.surroundings) advise_segments(options, rig);
    std::optional<training::RunClaim> claim;
    if (ranks.is_first()) claim = claim_file(options.clip());
    if (ranks.is_first() && !options.replaces.empty() && !options.settings.resume) begin_replacement(options);
    begun();
    if (ranks.count > 1) options.settings.team = join_team(ranks);
    if (!ranks.is_first()) options.live = {};
    RunView view{!ranks.is_first(), [&](double fraction) {
                     if (claim) claim->report(fraction);
                     return "";
                 }};
    bool complete = false;
    train_on(device_of_rank(ranks, common.device), options, [&](const gpu::Device& device) {
        if (ranks.is_first())
            say("training on {}{}\n", device.summary().name,
                ranks.count > 1 ? fmt::format(", the first of {} processes", ranks.count) : "");
        complete = train_rig(device, options, rig, view);
    });
    if (ranks.is_first()) conclude(options, complete);
}

// Trains the performer, and then what stands around it; of images without mattes that alone.
void run_with_surroundings(const TrainOptions& options, const CommonOptions& common) {
    if (is_in_segments(options) || options.init != "hull" || ranks_of_environment().count > 1 ||
        refine_of(options.refine).needs_search())
        throw InputError("--background", options.background,
                         "is for one tree of one process, without --segment, --init psi, and --refine but for colours",
                         "train the performer by a command of its own, without --background");
    TrainOptions around = options;
    around.surroundings = true;
    const training::Rig rig =
        training::read_rig(options.dataset, training::Split::kTrain, options.format, options.holdout);
    if (!training::has_mattes(rig)) {
        say("no image has a matte: whole images are learnt, as one still\n");
        return run_train(around, common);
    }
    training::expect_surroundings(rig);
    around.output.replace_extension(".background.nvv");
    around.live = {};
    around.audio = {};
    around.refine = {};
    around.max_megabytes = 0;  // bounds are those of the performer
    around.settings.max_leaves = 0;
    const bool is_begun =
        std::filesystem::exists(training::state_path(around.output)) || has_replacement(around.output);
    const bool is_finished = options.settings.resume && !is_begun && std::filesystem::exists(around.output);
    around.settings.resume = options.settings.resume && is_begun;
    if (!is_finished) training_place(around, false, common.overwrite);  // refuses before the performer is trained
    run_train(options, common);
    if (!stop_requested() && !is_finished) run_train(around, common);
}

std::string weight_option(const training::NamedLossWeight& weight) {
    return std::string("--lambda-") + weight.name;
}

// Names the given options that a resumed run ignores, because it keeps its own values.
void warn_of_ignored_options(const Command& verb) {
    std::string given;
    std::vector<std::string> names{"--resolution", "--bases",   "--hh-degree", "--init",   "--max-leaves",
                                   "--max-memory", "--uniform", "--seed",      "--refine", "--leave-out"};
    for (const training::NamedLossWeight& weight : training::kLossWeights) names.push_back(weight_option(weight));
    for (const std::string& name : names)
        if (verb.count(name) > 0) given += fmt::format("{}{}", given.empty() ? "" : ", ", name);
    if (!given.empty()) say("--resume: the run keeps its own {}, whatever is given now\n", given);
}

// What the octree begins as.
void add_init_options(Command verb, TrainOptions& options) {
    verb.add_option("--init", options.init, "What the octree begins as: the visual hull, or read off a network")
        .one_of({"hull", "psi"})
        .show_default();
    Option psi_minutes = verb.add_option("--psi-minutes", options.psi_minutes,
                                         "The network's own budget, before that of the octree, with --init psi")
                             .number_between(0.01, 1e5)
                             .show_default();
    verb.add_option(
            "--background", options.background,
            "learn: what stands still around the performer becomes an octree, too, NAME.background.nvv beside "
            "OUTPUT, in the same --minutes or --steps again; of images without mattes there is nothing else, "
            "and it is OUTPUT. Its --resolution counts leaves along an image (default: 200). Where both are learnt, "
            "--max-leaves and --max-memory bound the performer alone")
        .one_of({"learn"});
    verb.add_option("--psi-steps", options.psi_steps, "The same in steps")
        .in_range(1u, 1000000000u)
        .excludes(psi_minutes);
}

// How a clip is cut. Returns --plan.
Option add_segment_options(Command verb, TrainOptions& options) {
    verb.add_option("--segment", options.segment,
                    "Train the clip in segments of at most so many frames (4) or seconds (0.5s), each a tree of its "
                    "own (auto: a second, but fewer frames than --bases); OUTPUT becomes a folder. For clips of any "
                    "length: the memory of training does not grow with it "
                    "(default: one tree)");
    verb.add_option("--from", options.from,
                    "Train a part of a clip in segments again: those that have frames from this one on (24, 1.5s or "
                    "2:10), with a budget of their own. Those that are there are replaced, with --overwrite, once all "
                    "of the part are trained");
    verb.add_option("--to", options.to, "The first frame behind that part");
    return verb.add_flag("--plan", options.plan,
                         "With --segment: only write the folder and its index; with --resume in place of this, any "
                         "number of processes train it");
}

// How a run goes, and how it shows itself. `plan`: the option --plan.
void add_run_options(Command verb, TrainOptions& options, const Option& plan) {
    verb.add_option("--image-memory", options.image_gigabytes,
                    "GB that images may take in memory; more are streamed from disk (default: half of what is free, "
                    "shared by the ranks of a machine)")
        .number_between(1e-6, 1e6);
    verb.add_option("--seed", options.settings.seed, "Same seed, same batches").not_negative().show_default();
    verb.add_flag("--resume", options.settings.resume,
                  "Go on from OUTPUT.state; shape, bounds, losses, seed and --refine are the run's, --minutes or "
                  "--steps its whole budget. In segments: train those that are not finished and that no other process "
                  "trains")
        .excludes(plan);
    verb.add_option("--audio", options.audio,
                    "The clip's sound, from its first frame on: any file that has one, as a camera's video. It is "
                    "written beside OUTPUT as .m4a, where `publish` and stages find it");
    verb.add_option("--preview", options.live.preview,
                    "Keep this PNG showing a held-out image: truth, render, error; rewritten every few seconds");
    verb.add_option("--metrics", options.live.metrics,
                    "Append a line of JSON about once a second to this .jsonl file: step, loss, PSNR, leaves, ... "
                    "(see training/run/metrics_log.h); --resume continues it");
}

}  // namespace

void add_train(Command app, CommonOptions& common) {
    auto options = std::make_shared<TrainOptions>();
    Command verb = app.add_verb("train", "Train a volumetric video from a calibrated multi-view video");
    verb.add_option("dataset", options->dataset, "The data set's folder (see training/data/layouts/README.md)")
        .required();
    add_format_option(verb, options->format);
    add_holdout_option(verb, options->holdout);
    verb.add_option(
            "-o,--output", options->output,
            "The .nvv to write, with its .state beside it. One that is there is trained on by --resume; --overwrite "
            "trains it anew, as .NAME.new.nvv, which replaces it once it is whole")
        .required();
    Option minutes = verb.add_option("--minutes", options->settings.minutes, "Budget in wall time (default 20)")
                         .number_between(0.01, 1e5);
    verb.add_option("--steps", options->settings.steps, "Budget in steps").in_range(1u, 1000000000u).excludes(minutes);
    verb.add_option("--resolution", options->settings.shape.resolution,
                    "Finest leaves along the longest side (default: one a pixel at the scene's distance; half of that "
                    "where --minutes leave each leaf few rays)")
        .in_range(8u, training::kMaxResolution);
    verb.add_option("--bases", options->settings.shape.bases, "C: temporal bases; no more than the clip has frames")
        .in_range(1u, kMaxBases)
        .show_default();
    verb.add_option("--hh-degree", options->settings.shape.hh_degree, "n_max of the hyperspherical harmonics")
        .in_range(0u, kMaxHhDegree)
        .show_default();
    add_init_options(verb, *options);
    Option max_leaves = verb.add_option("--max-leaves", options->settings.max_leaves,
                                        "The tree never has more (default: what the device trains)")
                            .in_range(64u, voctree::kMaxLeaves);
    Option max_memory = verb.add_option("--max-memory", options->max_megabytes,
                                        "MB that the finished .nvv takes at most (default: any)")
                            .number_between(0.1, 1e6);
    verb.add_flag("--uniform", options->uniform, "Leaves stay of one size: no pruning, no division by the loss's pull")
        .excludes(max_leaves)
        .excludes(max_memory);
    verb.add_option("--leave-out", options->leave_out,
                    fmt::format("Parts of the training to leave out, for comparisons, with commas between them: {} "
                                "(training/run/schedule.h says what they are)",
                                fmt::join(training::kOptionalParts, ", ")));
    for (const training::NamedLossWeight& named : training::kLossWeights)
        verb.add_option(weight_option(named), options->settings.weights.*named.weight, named.meaning)
            .number_between(0.0, 100.0)
            .show_default();
    verb.add_option(
        "--refine", options->refine,
        "What else is learnt, of the cameras, one or more after commas. colour: gains and white balance; "
        "exposure: of each image; vignetting: lenses that darken towards the corners; poses: corrections "
        "of poses and focal lengths; time: cameras that are late or whose shutter rolls, not together with poses; "
        "auto, alone: those of "
        "these that are worth it; none, alone. poses, time and auto begin with a search, of a fifth of --minutes or "
        "--steps at most (default: colour and exposure, where the first part of the run shows that cameras differ; "
        "none in segments, with several processes, and of what --background learns)");
    const Option plan = add_segment_options(verb, *options);
    add_run_options(verb, *options, plan);
    verb.footer(
        {"Checkpoints go to OUTPUT during the run, so it can be watched, stopped with Ctrl-C and resumed.\n"
         "After Ctrl-C it saves, says that it was interrupted, and ends with exit code 0.\n"
         "mpirun refuses to start programs for root, as whom one works in many containers, unless it is given\n"
         "--allow-run-as-root. NEUVV_TRACE=1 prints the time of each pass. ",
         kDeviceHelp,
         "\n\nExamples, after `neuvv capture tools/performer/performer.glb -o work/performer`:\n"
         "  neuvv train work/performer -o work/performer.nvv --minutes 20\n"
         "  neuvv train work/performer -o work/performer.nvv --minutes 40 --resume\n"
         "  neuvv train work/performer -o work/live.nvv --preview work/live.png --metrics work/live.jsonl\n"
         "  neuvv train work/performer -o work/psi.nvv --init psi --psi-minutes 10 --minutes 20\n"
         "  neuvv train work/performer -o work/rig.nvv --refine auto\n"
         "  neuvv train work/performer -o work/light.nvv --max-memory 20\n"
         "  neuvv train work/checker -o work/show.nvv --background learn   # has a background\n"
         "  neuvv train work/performer -o work/long.nvv --segment 8 --minutes 20\n"
         "  neuvv train work/performer -o work/long.nvv --from 8 --to 16 --minutes 10 --overwrite\n"
         "  mpirun --bind-to none -n 2 neuvv train work/performer -o work/team.nvv --minutes 20\n"
         "  mpirun --bind-to none -n 2 neuvv train work/performer -o work/shared.nvv --segment 8 --minutes 20\n"
         "  neuvv train work/performer -o work/small.nvv --steps 500 --resolution 96 --bases 8"});
    verb.callback([options, verb, &common] {
        options->output = voctree::clip_path(options->output);
        // Segments that are not begun yet take all options of this command.
        if (options->settings.resume && !is_in_segments(*options) && ranks_of_environment().is_first())
            warn_of_ignored_options(verb);
        options->background.empty() ? run_train(*options, common) : run_with_surroundings(*options, common);
    });
}

}  // namespace neuvv::tools
