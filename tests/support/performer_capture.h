// A small capture of the bundled performer, made by the program, as the training images of a data set.
#pragma once

#include <gtest/gtest.h>

#include "support/child_process.h"
#include "support/temporary_folder.h"
#include "training/data/dataset.h"

namespace neuvv::test {

// 14 cameras, of which 13 are for training, two frames of 96×96 pixels. `folder` takes the files.
inline training::Dataset performer_capture(const std::filesystem::path& folder) {
    const std::string model = std::string(NEUVV_SOURCE_DIR) + "/tools/performer/performer.glb";
    ChildProcess capture(
        {NEUVV_PROGRAM, "capture", model, "-o", folder.string(), "--cameras", "14", "--frames", "2", "--size", "96x96"},
        folder / "log.txt");
    EXPECT_EQ(capture.wait(), 0) << read_text(folder / "log.txt");
    return training::load_dataset(folder, training::Split::kTrain);
}

}  // namespace neuvv::test
