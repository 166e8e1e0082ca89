// neuvv cluster: gives the training of a clip in segments to a cluster's scheduler.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "tools/commands.h"
#include "voctree/clip_index.h"

namespace neuvv::tools {

namespace {

constexpr const char* kExamples =
    "Examples, after `neuvv capture tools/performer/performer.glb -o build/performer`:\n"
    "  neuvv cluster sbatch --tasks 8 --sbatch=\"--gres=gpu:1 --time=4:00:00\" -- \\\n"
    "      train build/performer -o build/long.nvv --segment 8 --minutes 20\n"
    "  neuvv cluster sbatch --dry-run -- train build/performer -o build/long.nvv --segment 8 --steps 900\n"
    "  neuvv info build/long.nvv";

struct ClusterOptions {
    uint32_t tasks = 4;
    std::string sbatch;                // options for it, "--gres=gpu:1 --time=4:00:00"
    std::vector<std::string> command;  // "train", "data", "-o", …
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
    for (size_t i = 0; i < words.size(); i++)
        for (const std::string& name : names) {
            if (words[i] == name && i + 1 < words.size()) return words[i + 1];
            if (words[i].starts_with(name + "=")) return words[i].substr(name.size() + 1);
        }
    return std::nullopt;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

// The folder of the clip that the command trains. Throws InputError where the command is none that a cluster can share.
std::filesystem::path clip_of(const std::vector<std::string>& command) {
    constexpr const char* kFix =
        "write for instance: neuvv cluster sbatch -- train data -o show.nvv --segment 1s --minutes 60";
    if (command.empty() || command[0] != "train")
        throw InputError("COMMAND", command.empty() ? "" : command[0], "is not `train`", kFix);
    const std::optional<std::string> output = value_of(command, {"-o", "--output"});
    if (!output) throw InputError("COMMAND", joined(command), "has no --output", kFix);
    if (!has(command, "--resume") && !value_of(command, {"--segment"}))
        throw InputError("COMMAND", joined(command), "has no --segment: one tree is trained by one process", kFix);
    if (!value_of(command, {"--minutes"}) && !value_of(command, {"--steps"}))
        throw InputError("COMMAND", joined(command), "has no budget", "give --minutes or --steps, of the whole clip");
    if (has(command, "--plan"))
        throw InputError("COMMAND", joined(command), "has --plan, which comes of itself", "leave it out");
    return voctree::clip_path(*output);
}

// The job script. Two minutes before a task's time is over, Slurm sends SIGUSR1: the task saves, ends and asks to be
// queued again. On preemption and cancellation Slurm sends SIGTERM: the task saves and ends, and Slurm itself decides
// whether it comes back.
std::string script_of(const ClusterOptions& options, const std::filesystem::path& program,
                      const std::filesystem::path& clip) {
    std::vector<std::string> command = options.command;
    if (!has(command, "--resume")) command.emplace_back("--resume");
    const std::filesystem::path folder = std::filesystem::absolute(clip);
    std::string text = "#!/bin/sh\n";
    const auto line = [&](const std::string& option) { text += "#SBATCH " + option + "\n"; };
    line("--job-name=" + quoted(clip.stem().string()));
    line(fmt::format("--array=0-{}", options.tasks - 1));
    line("--requeue");
    line("--open-mode=append");
    line("--signal=B:USR1@120");
    line("--output=" + quoted(without_patterns(folder.string()) + "/log-%a.txt"));
    line("--chdir=" + quoted(std::filesystem::current_path().string()));
    if (!options.sbatch.empty()) line(options.sbatch);
    text += fmt::format(R"(
time_is_over=
trap 'interrupted=1; kill -TERM "$training"' TERM
trap 'interrupted=1; time_is_over=1; kill -TERM "$training"' USR1
{} {} &
training=$!
while :; do
    interrupted=
    wait "$training"
    code=$?
    [ "$interrupted" ] || break  # else a signal ended `wait`, and the program still saves
done
if [ "$time_is_over" ] && [ $code -eq 0 ]; then scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID"; fi
exit $code
)",
                        quoted(program.string()), joined(command));
    return text;
}

// Runs a program and passes on what it printed. Where it fails, throws an error of the same kind with its last line.
void run_or_throw(const std::vector<std::string>& words) {
    const ProgramOutput result = run_program(words);
    if (result.code == 0) {
        fmt::print("{}", result.text);
        return;
    }
    std::string line = result.text.substr(0, result.text.find_last_not_of('\n') + 1);
    line = line.substr(line.find_last_of('\n') + 1);
    const std::string name = words[0].substr(words[0].find_last_of('/') + 1);
    if (result.code == 2) throw InputError("COMMAND", name, line, "mend that");
    throw RuntimeFailure(fmt::format("{} ended with exit code {}: {}", name, result.code, line));
}

void run(const ClusterOptions& options) {
    const std::filesystem::path clip = clip_of(options.command), program = program_file();
    expect_one_line("--output", std::filesystem::absolute(clip).string());
    expect_one_line("the working directory", std::filesystem::current_path().string());
    expect_one_line("--sbatch", options.sbatch);
    if (!has(options.command, "--resume")) {
        std::vector<std::string> plan = options.command;
        plan.insert(plan.begin(), program.string());
        plan.emplace_back("--plan");
        run_or_throw(plan);
    }
    const std::filesystem::path script = clip / "job.sh";
    write_text_file(script, script_of(options, program, clip));
    if (options.dry_run) {
        fmt::print("wrote {}; `sbatch {}` submits it\n", script.string(), quoted(script.string()));
        return;
    }
    run_or_throw({"sbatch", script.string()});
    fmt::print("`neuvv info {}` says how far it is; the tasks' logs are {}/log-*.txt\n", clip.string(), clip.string());
}

}  // namespace

void add_cluster(Command app, CommonOptions&) {
    Command verb = app.add_verb("cluster", "Train a clip in segments on a cluster");
    verb.require_verb();
    verb.footer({kExamples});
    Command sbatch = verb.add_verb("sbatch", "Submit the training of a clip in segments to Slurm, as a job array");
    const auto options = std::make_shared<ClusterOptions>();
    sbatch.add_option("command", options->command, "After `--`: a `train` command with --segment, without `neuvv`")
        .required();
    sbatch
        .add_option("--tasks", options->tasks,
                    "Processes that train at the same time at most; --sbatch says what each gets")
        .in_range(1u, 10000u)
        .show_default();
    sbatch.add_option("--sbatch", options->sbatch,
                      "Options for sbatch in one word, such as --sbatch=\"--gres=gpu:1 --time=4:00:00\"");
    sbatch.add_flag("--dry-run", options->dry_run, "Write the job script and do not submit it");
    sbatch.footer(
        {"Plans the clip (`train --plan`), writes OUTPUT/job.sh and submits it. Each task trains segments until none "
         "is\n"
         "left. A task that is preempted, or whose time is nearly over, saves and is queued again; one that is killed "
         "leaves "
         "its\n"
         "segment to the others. With --resume in COMMAND, a clip that was begun goes on.\n"
         "Another scheduler needs a script that runs `neuvv COMMAND --resume` in as many tasks as wanted.\n\n",
         kExamples});
    sbatch.callback([options] { run(*options); });
}

}  // namespace neuvv::tools
