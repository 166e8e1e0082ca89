// Several processes that train one clip.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/seconds.h"
#include "render/clips/stage_renderer.h"
#include "support/child_process.h"
#include "support/mpirun.h"
#include "support/segmented_copy.h"
#include "tests/tools/cli_segments.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"

namespace neuvv {
namespace {

TEST_F(CliSharedTraining, ASecondProcessHelps) {
    ASSERT_EQ(run_neuvv(command("30", {"--plan"})).code, 0);
    EXPECT_EQ(voctree::read_clip_index(show).segments.size(), 3u);
    EXPECT_FALSE(std::filesystem::exists(segment(0)));
    const test::ChildProcess first(with_program(command("100000000", {"--resume"})), folder.path / "first");
    ASSERT_TRUE(first.until([&] { return std::filesystem::exists(segment(0)); })) << read_text(folder.path / "first");

    expect_refused(command("30", {}), 2, {"000000.nvv", "is being trained by process", "--resume"});
    const ProgramResult told = run_neuvv({"info", show, "--json"});
    const auto segments = nlohmann::json::parse(told.out).at("segments");
    EXPECT_NE(segments[0].at("training").at("owner").get<std::string>().find("process"), std::string::npos);
    EXPECT_FALSE(segments[1].contains("training"));

    const ProgramResult second = run_neuvv(command("30", {"--resume"}));
    EXPECT_EQ(second.code, 0) << second.err;
    EXPECT_EQ(second.out.find("000000.nvv: "), std::string::npos) << second.out;
    EXPECT_NE(second.out.find("segment 1 of 3 is left to process"), std::string::npos) << second.out;
    EXPECT_FALSE(std::filesystem::exists(training::state_path(segment(1))));
    EXPECT_TRUE(std::filesystem::exists(segment(2)));

    // The first is killed; what it had trained goes on elsewhere.
    first.send(SIGKILL);
    ASSERT_TRUE(first.until([&] { return first.ended(); }));
    const ProgramResult third = run_neuvv(command("30", {"--resume"}));
    EXPECT_EQ(third.code, 0) << third.err;
    EXPECT_NE(third.out.find("3 frames in 3 segments"), std::string::npos) << third.out;
    expect_finished();
}

TEST_F(CliSharedTraining, AReplacementThatIsBeingTrainedStays) {
    ASSERT_EQ(run_neuvv(command("3", {})).code, 0);
    ASSERT_EQ(run_neuvv(command("3", {"--overwrite", "--plan"})).code, 0);
    const std::string place = show + "/new.nvv";
    const auto claim = training::RunClaim::take(place + "/" + voctree::segment_file_name(1));
    ASSERT_TRUE(claim);
    expect_refused(command("3", {"--overwrite"}), 2, {"new.nvv/000001.nvv", "is being trained by process"});
    EXPECT_EQ(voctree::read_clip_index(place).segments.size(), 3u);
}

// The second rank finds what the first has begun.
TEST_F(CliSharedTraining, ThePreviewIsOfTheFirstRank) {
    const std::vector<std::string> words = command("3", {"--preview", file("shown.png")});
    const std::string ranks = "OMPI_COMM_WORLD_SIZE=2 PMIX_NAMESPACE=77 OMPI_COMM_WORLD_RANK=";
    for (const char* rank : {"0", "1"}) {
        const ProgramResult result = run_neuvv(words, ranks + rank);
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_TRUE(std::filesystem::exists(file("shown.png")));
    }
}

// On a full disk for instance. stdbuf: each line is written at once.
TEST_F(CliSharedTraining, AllIsTrainedWhereNobodyCanReadWhatItTells) {
    ASSERT_EQ(run_neuvv(command("3", {})).code, 0);
    const std::string before = read_text(segment(2));
    EXPECT_EQ(run_neuvv(command("6", {"--overwrite"}), "stdbuf -oL", ">/dev/full").code, 1);
    expect_finished();
    EXPECT_NE(read_text(segment(2)), before);
    EXPECT_FALSE(std::filesystem::exists(show + "/new.nvv"));
}

// The folder in the lock's place stands for a file system without locks.
TEST_F(CliSharedTraining, AFileIsReplacedWithoutALock) {
    std::filesystem::create_directory(file(".scene.new.nvv.replace"));
    const std::string before = read_text(scene);
    const ProgramResult result =
        run_neuvv({"train", file("data"), "-o", scene, "--resolution", "32", "--steps", "2", "--overwrite"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_NE(read_text(scene), before);
}

TEST_F(CliSharedTraining, OneFileIsTrainedByOneProcess) {
    std::vector<std::string> words = {"train", file("data"), "-o", file("one.nvv"), "--steps", "100000000"};
    const test::ChildProcess first(with_program(words), folder.path / "first");
    ASSERT_TRUE(first.until([&] { return std::filesystem::exists(file("one.nvv")); }));
    expect_refused(words, 2, {"one.nvv", "is being trained by process"});
}

// Training by ranks of mpirun. Only these cases need Open MPI, without which the program works (support/mpirun.h).
struct CliMpiTraining : CliSharedTraining {
    void SetUp() override {
        CliSharedTraining::SetUp();
        if (!test::prepare_mpirun()) GTEST_SKIP() << "needs mpirun (package openmpi-bin)";
    }
};

// Whether a process is rank 0 of Open MPI, which alone tells of the whole run.
bool is_first_rank(int64_t process) {
    return read_text(fmt::format("/proc/{}/environ", process)).find("OMPI_COMM_WORLD_RANK=0") != std::string::npos;
}

// What mpirun starts: three ranks, one of which is killed.
TEST_F(CliMpiTraining, ARankIsKilled) {
    test::ChildProcess job(test::under_mpirun("3", with_program(command("1500", {})), {"--enable-recovery"}),
                           folder.path / "log");
    const auto log = [&] { return read_text(folder.path / "log"); };
    int64_t process = 0;
    uint32_t victim = 0;  // a segment that another rank than the first trains
    const auto can_be_killed = [&](uint32_t index) {
        const std::optional<training::ClaimState> claim = training::claim_of(segment(index));
        return claim && claim->fraction > 0 && std::filesystem::exists(training::state_path(segment(index))) &&
               std::sscanf(claim->owner.c_str(), "process %ld of", &process) == 1 && !is_first_rank(process);
    };
    ASSERT_TRUE(job.until([&] {
        for (victim = 0; victim < 3; ++victim)
            if (can_be_killed(victim)) return true;
        return false;
    })) << log();
    kill(static_cast<pid_t>(process), SIGKILL);
    job.wait();  // mpirun ends with the code of the rank that was killed
    EXPECT_NE(log().find("wrote " + show + ": 3 frames in 3 segments"), std::string::npos) << log();
    EXPECT_NE(log().find("wrote " + segment(victim) + ": "), std::string::npos) << "by another rank: " << log();
    expect_finished();
}

// Whether nobody trains into the file any more, at the latest in a minute: mpirun kills ranks that do not end within a
// second of its signal, and ends itself before the system has taken down what they had.
bool ends_soon(const std::filesystem::path& nvv) {
    const double start = seconds_now();
    while (training::claim_of(nvv)) {
        if (seconds_now() > start + 60) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
}

// Two ranks that train one tree, ended together in the centre.
TEST_F(CliMpiTraining, RanksShareOneTree) {
    const auto ranks = [&](const char* steps, const std::vector<std::string>& more) {
        std::vector<std::string> words =
            with_program({"train", file("data"), "-o", file("one.nvv"), "--steps", steps, "--resolution", "32"});
        words.insert(words.end(), more.begin(), more.end());
        return test::under_mpirun("2", words, {"--mca", "odls_base_sigkill_timeout", "3"});
    };
    const auto log = [&] { return read_text(folder.path / "log"); };
    {
        test::ChildProcess first(ranks("100000000", {}), folder.path / "log");
        ASSERT_TRUE(first.until([&] { return log().find("k rays/s") != std::string::npos; })) << log();
        first.send(SIGTERM);  // mpirun passes it on
        ASSERT_TRUE(first.until([&] { return first.ended(); }));
        EXPECT_NE(log().find("the first of 2 processes"), std::string::npos) << log();
    }
    ASSERT_TRUE(ends_soon(file("one.nvv"))) << log();
    const uint64_t reached = training::load_checkpoint(file("one.nvv")).run.step;
    const std::string whole = std::to_string(reached + 20);
    test::ChildProcess second(ranks(whole.c_str(), {"--resume"}), folder.path / "log");
    EXPECT_EQ(second.wait(), 0) << log();
    EXPECT_EQ(training::load_checkpoint(file("one.nvv")).run.step, reached + 20);
    EXPECT_EQ(voctree::read_nvv(file("one.nvv")).frames, 3u);
    ASSERT_NE(log().find("wrote "), std::string::npos) << log();
    EXPECT_EQ(log().find("wrote "), log().rfind("wrote ")) << "one rank says it: " << log();
}

}  // namespace
}  // namespace neuvv
