// A clip in segments for tests of the command line, and a data set that several processes train.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"

namespace neuvv {

struct CliSegments : CliGpu {
    std::string parts = file("parts.nvv");

    void SetUp() override {
        CliGpu::SetUp();
        write_segmented_copy(tree, {1, 3}, parts);
    }
    media::Image still(const std::string& clip, const char* time) {
        const std::string show = file("show.gltf");
        test::write_stage(show, clip, "anna");
        const ProgramResult result =
            run_neuvv({"render", show, "-o", file("still.png"), "--size", "64x48", "--time", time, "--overwrite"});
        EXPECT_EQ(result.code, 0) << result.err;
        return media::read_png(file("still.png"));
    }
    // The first frames of the segments that have lines in log.jsonl.
    std::set<int> segments_logged() const {
        std::set<int> first;
        std::istringstream lines(read_text(file("log.jsonl")));
        for (std::string line; std::getline(lines, line);)
            first.insert(nlohmann::json::parse(line).at("first_frame").get<int>());
        return first;
    }
    nlohmann::json eval(const std::string& clip) {
        const ProgramResult result =
            run_neuvv({"eval", "--overwrite", clip, file("data"), "--samples", "1", "--json", "-"});
        EXPECT_EQ(result.code, 0) << result.err;
        return nlohmann::json::parse(result.out);
    }
};

// Several processes that train one clip of three segments.
struct CliSharedTraining : CliSegments {
    std::string show = file("show.nvv");

    void SetUp() override {
        CliSegments::SetUp();
        write_own_data();
        std::filesystem::rename(folder.path / "data/transforms_test.json", folder.path / "data/transforms_train.json");
    }
    std::vector<std::string> command(const char* steps, std::vector<std::string> more) const {
        std::vector<std::string> words = {"train", file("data"), "-o",  show,           "--segment",
                                          "1",     "--steps",    steps, "--resolution", "32"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    static std::vector<std::string> with_program(std::vector<std::string> words) {
        words.insert(words.begin(), NEUVV_PROGRAM);
        return words;
    }
    std::string segment(uint32_t frame) const { return show + "/" + voctree::segment_file_name(frame); }
    void expect_finished() const {
        for (const uint32_t frame : {0u, 1u, 2u}) {
            EXPECT_EQ(voctree::read_nvv(segment(frame)).frames, 1u);
            EXPECT_FALSE(std::filesystem::exists(training::state_path(segment(frame))));
            EXPECT_FALSE(training::claim_of(segment(frame)));
        }
        EXPECT_FALSE(training::claim_of(show));
    }
};

}  // namespace neuvv
