// A clip that is trained anew beside the finished one, which it replaces once it is whole: .NAME.new.nvv beside
// NAME.nvv, hidden so that no clip of the user has that name, or the folder new.nvv in that of a clip in segments.
#pragma once

#include <filesystem>

#include "tools/train/train_run.h"

namespace neuvv::tools {

std::filesystem::path replacement_of(const std::filesystem::path& clip);

// Whether a training of the replacement was begun and is not finished.
bool has_replacement(const std::filesystem::path& clip);

// Where the run trains: the output, or its replacement. Throws InputError where the output holds what was trained, and
// the user says neither --overwrite nor --resume.
std::filesystem::path training_place(const TrainOptions& options, bool in_segments, bool overwrite);

// Begins the replacement: removes one that was not finished. Where a part of a clip is trained again, it gets the other
// segments and what else belongs to the clip. Throws InputError where other processes train the one that is there, and
// RuntimeFailure.
void begin_replacement(const TrainOptions& options);

// Whether another process has finished the replacement meanwhile.
bool is_replaced(const TrainOptions& options);

// Moves the files of the replacement, which is whole, into the place of those of the clip. It is done again from where
// it was interrupted. Throws RuntimeFailure.
void finish_replacement(const TrainOptions& options);

}  // namespace neuvv::tools
