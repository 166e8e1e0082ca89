// Runs verbs of `neuvv` from the window: capture, import, train, publish, export. A verb runs as a process of its own,
// so that it does what it does on the command line, and an error of it leaves the window alone.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/child_program.h"
#include "tools/viewer/verbs/verb_form.h"

namespace neuvv::viewer {

class VerbTask {
  public:
    // `device` is what --device said when the window was opened; empty: nothing. `program` is `neuvv`.
    VerbTask(std::string device, std::filesystem::path program)
        : device_(std::move(device)), program_file_(std::move(program)) {}

    // Opens the dialog of a verb. While a verb runs, the dialog of that one stays.
    void ask(const std::string& verb, const std::filesystem::path& input = {});
    void close();
    bool is_open() const { return form_ != nullptr; }
    // Back from what an ended verb said to its form.
    void back() { code_.reset(); }

    // Starts the verb. Throws RuntimeFailure.
    void start();
    void stop();
    bool is_running() const { return program_.has_value(); }
    // To be called once a frame: takes what the verb has printed. Returns whether anything has changed.
    bool tick();

    const VerbForm& form() const { return *form_; }
    std::vector<std::string> values;  // of the form's fields
    bool overwrite = false;           // what is there already may be replaced
    std::vector<std::string> arguments() const;

    double progress() const { return progress_; }                    // 0 to 1; negative: not known
    const std::string& status() const { return status_; }            // the last line about it
    const std::deque<std::string>& lines() const { return lines_; }  // all others, the newest last
    std::optional<int> code() const { return code_; }                // of the verb that ended last; nullopt: none has

  private:
    static constexpr size_t kMostLines = 200;

    std::string device_, status_;
    std::filesystem::path program_file_;
    const VerbForm* form_ = nullptr;
    std::optional<ChildProgram> program_;
    std::deque<std::string> lines_;
    double progress_ = -1;
    std::optional<int> code_;
};

}  // namespace neuvv::viewer
