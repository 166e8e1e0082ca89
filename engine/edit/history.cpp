#include "edit/history.h"

namespace neuvv {

void History::did(nlohmann::ordered_json before, std::string what) {
    redo_.clear();
    undo_.push_back({std::move(before), std::move(what)});
    if (undo_.size() > limit_) undo_.pop_front();
}

std::optional<std::string> History::step(StageFile& file, std::deque<Step>& from, std::deque<Step>& to) {
    if (from.empty()) return {};
    Step step = std::move(from.back());
    from.pop_back();
    std::swap(step.document, file.json);
    std::string what = step.what;
    to.push_back(std::move(step));
    return what;
}

std::optional<std::string> History::undo(StageFile& file) {
    return step(file, undo_, redo_);
}

std::optional<std::string> History::redo(StageFile& file) {
    return step(file, redo_, undo_);
}

}  // namespace neuvv
