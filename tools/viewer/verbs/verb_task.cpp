#include "tools/viewer/verbs/verb_task.h"

namespace neuvv::viewer {

void VerbTask::ask(const std::string& verb, const std::filesystem::path& input) {
    if (is_running()) return;
    form_ = &form_of(verb);
    values = first_values(*form_);
    if (!input.empty()) set_input(*form_, input, values);
    overwrite = false;
    lines_.clear();
    status_.clear();
    code_.reset();
}

void VerbTask::close() {
    if (!is_running()) form_ = nullptr;
}

std::vector<std::string> VerbTask::arguments() const {
    std::vector<std::string> arguments = arguments_of(*form_, values);
    if (overwrite) arguments.emplace_back("--overwrite");
    if (!device_.empty()) arguments.insert(arguments.end(), {"--device", device_});
    return arguments;
}

void VerbTask::start() {
    lines_.clear();
    status_.clear();
    progress_ = -1;
    code_.reset();
    std::vector<std::string> command = arguments();
    command.insert(command.begin(), program_file_.string());
    program_.emplace(std::move(command), std::vector<std::string>{"NEUVV_STATUS_MS=300"});
}

void VerbTask::stop() {
    if (program_) program_->stop();
}

bool VerbTask::tick() {
    if (!program_) return false;
    bool changed = false;
    while (std::optional<std::string> line = program_->next_line()) {
        changed = true;
        if (const double share = progress_of(*line); share >= 0) {
            progress_ = share;
            status_ = std::move(*line);
            continue;
        }
        lines_.push_back(std::move(*line));
        if (lines_.size() > kMostLines) lines_.pop_front();
    }
    if (!program_->has_ended()) return changed;
    code_ = program_->wait();
    program_.reset();
    return true;
}

}  // namespace neuvv::viewer
