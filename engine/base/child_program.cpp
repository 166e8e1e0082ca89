#include "base/child_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace neuvv {

namespace {

constexpr size_t kLongestLine = 1 << 16;
constexpr int kAsk_ms = 50, kUnknownCode = 128;

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

// This process's environment with more variables, which replace those of the same name.
std::vector<std::string> environment_with(const std::vector<std::string>& more) {
    std::vector<std::string> all = more;
    for (char** at = environ; *at; ++at) {
        const std::string variable = *at;
        const std::string name = variable.substr(0, variable.find('=') + 1);
        bool replaced = false;
        for (const std::string& one : more) replaced |= one.starts_with(name);
        if (!replaced) all.push_back(variable);
    }
    return all;
}

// A process may have been started with SIGCHLD ignored. Then the system forgets how its children ended.
void remember_children() {
    struct sigaction now = {};
    sigaction(SIGCHLD, nullptr, &now);
    if (now.sa_handler == SIG_IGN) signal(SIGCHLD, SIG_DFL);
}

// A program in the background of a script ignores SIGINT, and so would its children, which could not be asked to stop.
void default_signals(posix_spawnattr_t& attributes) {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
}

}  // namespace

ChildProgram::ChildProgram(std::vector<std::string> arguments, const std::vector<std::string>& environment) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw RuntimeFailure(fmt::format("{}: {}", arguments[0], std::strerror(errno)));
    remember_children();
    std::vector<std::string> variables = environment_with(environment);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    default_signals(attributes);
    const int failed = posix_spawnp(&process_, arguments[0].c_str(), &actions, &attributes, pointers(arguments).data(),
                                    pointers(variables).data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (failed) {
        close(ends[0]);
        throw RuntimeFailure(fmt::format("{} cannot be started: {}", arguments[0], std::strerror(failed)));
    }
    output_ = ends[0];
    lines_.emplace(output_, kLongestLine);
}

ChildProgram::~ChildProgram() {
    stop();
    wait();
    close(output_);
}

std::optional<std::string> ChildProgram::next_line(int wait_ms) {
    if (closed_ && wait_ms > 0) poll(nullptr, 0, wait_ms);
    std::string line;
    const LineReader::Result result = closed_ ? LineReader::Result::kEnd : lines_->next(line, wait_ms);
    closed_ = result == LineReader::Result::kEnd;
    if (result != LineReader::Result::kLine) return {};
    return line;
}

// Takes the exit code, where the program has ended or `flags` let it wait for that. Where something else in this
// process has taken it, it is not known.
bool ChildProgram::reap(int flags) {
    if (code_) return true;
    int status = 0;
    pid_t ended = 0;
    while ((ended = waitpid(process_, &status, flags)) < 0 && errno == EINTR) {
    }
    if (ended < 0) code_ = kUnknownCode;
    if (ended != process_) return code_.has_value();
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return true;
}

bool ChildProgram::has_ended() {
    return closed_ && reap(WNOHANG);
}

// What it prints until then is read, as a program that writes into a full pipe never ends.
int ChildProgram::wait() {
    while (!closed_ && !reap(WNOHANG)) next_line(kAsk_ms);
    reap(0);
    return *code_;
}

void ChildProgram::stop() const {
    if (!code_) kill(process_, SIGINT);
}

ProgramOutput run_program(std::vector<std::string> arguments) {
    ChildProgram program(std::move(arguments));
    ProgramOutput output;
    while (!program.has_ended())
        if (const std::optional<std::string> line = program.next_line(kAsk_ms)) output.text += *line + "\n";
    output.code = program.wait();
    return output;
}

}  // namespace neuvv
