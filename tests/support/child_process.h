// A program that runs as a child process, which a test may kill.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace neuvv::test {

class ChildProcess {
  public:
    // Starts the program; what it prints is written to `log`.
    ChildProcess(std::vector<std::string> arguments, const std::filesystem::path& log) {
        std::vector<char*> argv;
        for (std::string& argument : arguments) argv.push_back(argument.data());
        argv.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        posix_spawn_file_actions_adddup2(&actions, 1, 2);
        // What ignores signals, such as nohup or the background of a script, would have its children ignore them, too.
        sigset_t all;
        sigfillset(&all);
        posix_spawnattr_t attributes;
        posix_spawnattr_init(&attributes);
        posix_spawnattr_setsigdefault(&attributes, &all);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
        const int failed = posix_spawn(&pid_, argv[0], &actions, &attributes, argv.data(), environ);
        posix_spawnattr_destroy(&attributes);
        posix_spawn_file_actions_destroy(&actions);
        if (failed) throw std::runtime_error("cannot start " + arguments[0]);
    }
    ~ChildProcess() {
        if (pid_ <= 0) return;
        send(SIGKILL);
        wait();
    }
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    void send(int signal) const { kill(pid_, signal); }
    // Waits for the end; returns the exit code, or minus the signal's number where a signal ended the process.
    int wait() {
        int status = 0;
        waitpid(pid_, &status, 0);
        pid_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    }
    bool ended() const {
        siginfo_t info{};
        return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid != 0;
    }
    // Waits for a condition. Returns false where the process ends or four minutes pass before the condition is true.
    bool until(const std::function<bool()>& condition) const {
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(4);
        while (!condition()) {
            if (ended() || std::chrono::steady_clock::now() > end) return condition();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return true;
    }

  private:
    pid_t pid_ = 0;
};

}  // namespace neuvv::test
