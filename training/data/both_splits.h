// The training and the test split of a data set together, for what is done with all images.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

struct BothSplits {
    std::vector<Rig> rigs;      // those that can be read, at least one
    std::vector<Split> splits;  // of each of them
    Note missing;               // why one of the two cannot be, as a data set need not have both; else empty
};

// Throws InputError where neither can be read.
BothSplits read_both_splits(const std::filesystem::path& folder, const std::string& format,
                            const std::string& holdout = "");

// Adds the images for the validation, where the layout has such; where they cannot be read, the first rig gets a
// remark.
void add_validation(BothSplits& both, const std::filesystem::path& folder, const std::string& format);

// How many times the images of all splits have.
size_t frame_count(const BothSplits& both);

// Leaves the images of the frames `first` to `last`, which are counted from 0 over these times; the clip becomes as
// long as they are. A validation that has none of them is left out. Throws InputError where another split has none.
void keep_frames(BothSplits& both, size_t first, size_t last);

// Throws InputError where two images of the splits have one name, or one is called `taken`, of files that are to be
// written into `folder`, "the mattes' folder".
void expect_distinct_names(const std::vector<Rig>& rigs, const std::string& folder, const std::string& taken = "");

}  // namespace neuvv::training
