// neuvv cluster: gives the training of a clip in segments, or a render in parts, to a cluster's scheduler.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/child_program.h"
#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "media/image_sink.h"
#include "tools/commands.h"
#include "tools/render/render_part.h"
#include "tools/say.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

namespace {

constexpr const char* kExamples =
    "Examples, after `neuvv capture tools/performer/performer.glb -o work/performer`:\n"
    "  neuvv cluster sbatch --tasks 8 --sbatch=\"--gres=gpu:1 --time=4:00:00\" -- \\\n"
    "      train work/performer -o work/long.nvv --segment 8 --minutes 20\n"
    "  neuvv cluster sbatch --dry-run -- train work/performer -o work/long.nvv --segment 8 --steps 900\n"
    "  neuvv info work/long.nvv\n"
    "  neuvv cluster sbatch --tasks 8 -- render work/long.nvv -o work/turn.mp4 --size 1920x1080";

struct ClusterOptions {
    uint32_t tasks = 4;
    std::string sbatch;                // options for it, "--gres=gpu:1 --time=4:00:00"
    std::vector<std::string> command;  // "train", "data", "-o", …, or "render", …
    bool dry_run = false;
};

std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + quoted(word);
    return text;
}

// A path in which Slurm finds no patterns such as %a.
std::string without_patterns(const std::string& path) {
    std::string text;
    for (const char c : path) text += c == '%' ? "%%" : std::string(1, c);
    return text;
}

// A line break would end a comment of the job script, and the shell would run the rest.
void expect_one_line(const std::string& what, const std::string& text) {
    if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }))
        throw InputError(what, "", "holds a line break or another control character", "choose another name");
}

// The value of an option among words, written "-o x", "--output x" or "--output=x".
std::optional<std::string> value_of(const std::vector<std::string>& words, const std::vector<std::string>& names) {
    for (size_t i = 0; i < words.size(); ++i)
        for (const std::string& name : names) {
            if (words[i] == name && i + 1 < words.size()) return words[i + 1];
            if (words[i].starts_with(name + "=")) return words[i].substr(name.size() + 1);
        }
    return std::nullopt;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

// What is submitted: a job array whose tasks all run the same command.
struct Job {
    std::filesystem::path folder;  // of the job script and the logs
    std::string name;
    std::string task;               // the command of a task, without the program, as the shell reads it
    std::vector<std::string> plan;  // the command that checks or plans it before; empty: none is needed
    // The exit code of a task that was told that its time is nearly over, and that has more to do.
    int unfinished_code = 0;
};

std::string output_of(const std::vector<std::string>& command, const char* fix) {
    const std::optional<std::string> output = value_of(command, {"-o", "--output"});
    if (!output) throw InputError("COMMAND", joined(command), "has no --output", fix);
    return *output;
}

// The command with --plan. Of training, running it writes the folder and the index of the clip, with which all tasks
// then go on.
std::vector<std::string> with_plan(std::vector<std::string> command) {
    if (has(command, "--plan"))
        throw InputError("COMMAND", joined(command), "has --plan, which comes of itself", "leave it out");
    command.emplace_back("--plan");
    return command;
}

// Throws InputError where the command is none that a cluster can share.
Job training_job(const std::vector<std::string>& command) {
    constexpr const char* kFix =
        "write for instance: neuvv cluster sbatch -- train data -o show.nvv --segment 1s --minutes 60";
    const std::filesystem::path clip = voctree::clip_path(output_of(command, kFix));
    if (!has(command, "--resume") && !value_of(command, {"--segment"}))
        throw InputError("COMMAND", joined(command), "has no --segment, whose segments the tasks would train", kFix);
    if (!value_of(command, {"--minutes"}) && !value_of(command, {"--steps"}))
        throw InputError("COMMAND", joined(command), "has no budget", "give --minutes or --steps, of the whole clip");
    for (const char* option : {"--preview", "--metrics"})
        if (value_of(command, {option}))
            throw InputError("COMMAND", joined(command), fmt::format("has {}, which is for one process", option),
                             "leave it out; tasks have logs");
    std::vector<std::string> task = command, plan = with_plan(command);
    if (has(command, "--resume"))
        plan.clear();  // the clip is there
    else
        task.emplace_back("--resume");
    return {clip, clip.stem().string(), joined(task), plan, 0};
}

// Throws InputError where the command renders nothing that has parts.
Job render_job(const std::vector<std::string>& command, uint32_t tasks) {
    const media::ImageOutput output = media::parse_output(
        output_of(command, "write for instance: neuvv cluster sbatch -- render show.nvv -o turn.mp4"));
    if (output.kind == media::ImageOutput::Kind::kImage)
        throw InputError("COMMAND", output.path.string(), "is a single image", "render it without a cluster");
    if (has(command, "--part") || value_of(command, {"--part"}))
        throw InputError("COMMAND", joined(command), "has --part, which comes of itself", "leave it out");
    std::vector<std::string> task = command, plan = with_plan(command);
    if (!has(command, "--resume")) task.emplace_back("--resume");
    plan.insert(plan.end(), {"--part", fmt::format("1/{}", tasks)});
    return {folder_of_parts(output), folder_of_parts(output).stem().string(),
            fmt::format("{} --part \"$((SLURM_ARRAY_TASK_ID + 1))/{}\"", joined(task), tasks), plan, 1};
}

Job job_of(const ClusterOptions& options) {
    const std::string verb = options.command.empty() ? "" : options.command[0];
    if (verb == "train") return training_job(options.command);
    if (verb == "render") return render_job(options.command, options.tasks);
    throw InputError("COMMAND", verb, "is neither `train` nor `render`",
                     "write for instance: neuvv cluster sbatch -- train data -o show.nvv --segment 1s --minutes 60, or "
                     "neuvv cluster sbatch -- render show.nvv -o turn.mp4");
}

// The job script. Two minutes before a task's time is over, Slurm sends SIGUSR1: the task saves, ends and asks to be
// queued again. On preemption and cancellation Slurm sends SIGTERM:
// the task saves and ends, and Slurm itself decides whether it comes back.
std::string script_of(const ClusterOptions& options, const std::filesystem::path& program, const Job& job) {
    const std::filesystem::path folder = std::filesystem::absolute(job.folder);
    std::string text = "#!/bin/sh\n";
    const auto line = [&](const std::string& option) { text += "#SBATCH " + option + "\n"; };
    line("--job-name=" + quoted(job.name));
    line(fmt::format("--array=0-{}", options.tasks - 1));
    line("--requeue");
    line("--open-mode=append");
    line("--signal=B:USR1@120");
    line("--output=" + quoted(without_patterns(folder.string()) + "/log-%a.txt"));
    line("--chdir=" + quoted(std::filesystem::current_path().string()));
    if (!options.sbatch.empty()) line(options.sbatch);
    text += fmt::format(R"(
time_is_over=
trap 'interrupted=1; kill -TERM "$task"' TERM
trap 'interrupted=1; time_is_over=1; kill -TERM "$task"' USR1
{} {} &
task=$!
while :; do
    interrupted=
    wait "$task"
    code=$?
    [ "$interrupted" ] || break  # else a signal ended `wait`, and the program still saves
done
if [ "$time_is_over" ] && [ $code -eq {} ]; then scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID"; fi
exit $code
)",
                        quoted(program.string()), job.task, job.unfinished_code);
    return text;
}

// Runs a program and passes on what it printed. Where it fails, throws an error of the same kind with its last line.
void run_or_throw(const std::vector<std::string>& words) {
    const ProgramOutput result = run_program(words);
    if (result.code == 0) {
        tell("{}", result.text);
        return;
    }
    std::string line = result.text.substr(0, result.text.find_last_not_of('\n') + 1);
    line = line.substr(line.find_last_of('\n') + 1);
    const std::string name = words[0].substr(words[0].find_last_of('/') + 1);
    if (result.code == 2) throw InputError("COMMAND", name, line, "mend that");
    throw RuntimeFailure(fmt::format("{} ended with exit code {}: {}", name, result.code, line));
}

void run(const ClusterOptions& options, bool overwrite) {
    const std::filesystem::path program = program_file();
    expect_one_line("the working directory", std::filesystem::current_path().string());
    expect_one_line("--sbatch", options.sbatch);
    expect_one_line("COMMAND", joined(options.command));
    Job job = job_of(options);
    const bool trains = options.command[0] == "train";
    if (overwrite && !job.plan.empty()) job.plan.emplace_back("--overwrite");
    if (!job.plan.empty()) {
        job.plan.insert(job.plan.begin(), program.string());
        run_or_throw(job.plan);
    }
    if (!trains) prepare_output_folder("--output", job.folder);
    const std::filesystem::path script = job.folder / "job.sh";
    write_text_file(script, script_of(options, program, job));
    if (options.dry_run) {
        tell("wrote {}; `sbatch {}` submits it\n", script.string(), quoted(script.string()));
        return;
    }
    if (!trains && !has(options.command, "--resume"))
        media::forget_renders(media::parse_output(output_of(options.command, "")));
    run_or_throw({"sbatch", script.string()});
    if (trains)
        tell("`neuvv info {}` says how far it is; ", job.folder.string());
    else
        tell("`squeue` lists the tasks that are left; ");
    tell("the tasks' logs are {}/log-*.txt\n", job.folder.string());
}

}  // namespace

void add_cluster(Command app, CommonOptions& common) {
    Command verb = app.add_verb("cluster", "Train a clip in segments, or render in parts, on a cluster");
    verb.require_verb();
    verb.footer({kExamples});
    Command sbatch =
        verb.add_verb("sbatch", "Submit the training of a clip in segments, or a render, to Slurm, as a job array");
    const auto options = std::make_shared<ClusterOptions>();
    sbatch
        .add_option("command", options->command,
                    "After `--`, without `neuvv`: a `train` command with --segment, or a `render` command")
        .required();
    sbatch
        .add_option(
            "--tasks", options->tasks,
            "Processes that work at the same time at most, and the parts of a render; --sbatch says what each gets")
        .in_range(1u, 10000u)
        .show_default();
    sbatch.add_option("--sbatch", options->sbatch,
                      "Options for sbatch in one word, such as --sbatch=\"--gres=gpu:1 --time=4:00:00\"");
    sbatch.add_flag("--dry-run", options->dry_run, "Write the job script and do not submit it");
    sbatch.footer(
        {"Plans the clip (`train --plan`) or checks the render (`render --plan`), writes OUTPUT/job.sh and\n"
         "submits it. Each task trains segments until none is left. A task that is preempted, or whose time\n"
         "is nearly over, saves and is queued again; one that is killed leaves its segment to the others.\n"
         "With --resume in COMMAND, a clip that was begun goes on.\n"
         "Of a render, each task renders a part of the images, so there must be as many images as tasks at least. The\n"
         "task that ends last joins the parts of a video. The job's script and logs lie in OUTPUT.parts, of\n"
         "out_%04d.png in out_render.parts. The same command again renders parts of a video that are missing; of\n"
         "numbered images, it begins anew without --resume.\n"
         "Another scheduler needs a script that runs `neuvv COMMAND --resume` in as many tasks as wanted, of a render\n"
         "with another --part K/N in each.\n\n",
         kExamples});
    sbatch.callback([options, &common] {
        // What is there is replaced by the plan, not by each task.
        const bool overwrite = std::erase(options->command, "--overwrite") > 0 || common.overwrite;
        run(*options, overwrite);
    });
}

}  // namespace neuvv::tools
