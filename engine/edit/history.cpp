#include "edit/history.h"

#include <set>

namespace neuvv::edit {

uint64_t History::extra_bytes(const Document& document) const {
    std::set<const void*> counted;
    const auto count = [&](const stage::StageJson& json, const PaintLayers& paint) {
        uint64_t bytes = 0;
        for (const auto& [value, size] : json.sizes())
            if (counted.insert(value).second) bytes += size;
        for (const auto& [path, layer] : paint)
            if (counted.insert(layer.get()).second) bytes += layer->edits.size() * sizeof(voctree::LeafEdit);
        return bytes;
    };
    count(document.file.json, document.paint);
    uint64_t extra = 0;
    for (const std::deque<Step>* steps : {&undo_, &redo_})
        for (const Step& step : *steps) extra += count(step.json, step.paint);
    return extra;
}

void History::add_step(Document before, const Document& after, std::string what, std::optional<uint32_t> selected) {
    redo_.clear();
    undo_.push_back(
        {before.file.path, std::move(before.file.json), std::move(before.paint), revision_, std::move(what), selected});
    revision_ = ++last_revision_;
    while (undo_.size() > 1 && (undo_.size() > step_limit_ || extra_bytes(after) > byte_limit_)) undo_.pop_front();
}

std::optional<std::string> History::step(Document& document, uint64_t& revision, std::optional<uint32_t>* selected,
                                         std::deque<Step>& from, std::deque<Step>& to) {
    if (from.empty()) return {};
    stage::StageFile& file = document.file;
    stage::StageFile target = stage::moved_to({from.back().path, from.back().json, {}}, file.path);
    Step step = std::move(from.back());
    from.pop_back();
    // Layers that were opened since the step are kept as they were opened, because their first edit is a later step.
    step.paint.insert(document.paint.begin(), document.paint.end());
    step.path = file.path;
    step.json = std::exchange(file.json, std::move(target.json));
    std::swap(step.paint, document.paint);
    std::swap(step.revision, revision);
    if (selected) std::swap(step.selected, *selected);
    std::string what = step.what;
    to.push_back(std::move(step));
    return what;
}

std::optional<std::string> History::undo(Document& document, std::optional<uint32_t>* selected) {
    return step(document, revision_, selected, undo_, redo_);
}

std::optional<std::string> History::redo(Document& document, std::optional<uint32_t>* selected) {
    return step(document, revision_, selected, redo_, undo_);
}

}  // namespace neuvv::edit
