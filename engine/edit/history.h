// Undo and redo: documents as they were before and after each operation.
#pragma once

#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "stage/stage_file.h"

namespace neuvv {

class History {
  public:
    // Keeps so many steps; older ones are forgotten.
    explicit History(size_t limit = 100) : limit_(limit) {}

    // After an operation: the document as it was before it, and what it said. What was undone cannot be redone then.
    void did(nlohmann::ordered_json before, std::string what);

    // Puts the document back by a step, or forward again; what the step was, nothing where there is none.
    std::optional<std::string> undo(StageFile& file);
    std::optional<std::string> redo(StageFile& file);

  private:
    struct Step {
        nlohmann::ordered_json document;  // before the step where it can be undone, after it where it can be redone
        std::string what;
    };
    static std::optional<std::string> step(StageFile& file, std::deque<Step>& from, std::deque<Step>& to);
    size_t limit_;
    std::deque<Step> undo_, redo_;
};

}  // namespace neuvv
