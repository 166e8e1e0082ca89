// Sources of poses from pipes and files, on a clock of the test's own; addresses.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include "motion/detector.h"
#include "motion/live/pose_source.h"
#include "motion/senders.h"
#include "motion/sent_pose.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv::pose_source_test {
namespace {

TEST(PoseSource, SaysWhatIsWrongWithAnAddress) {
    const auto refuse = [](const std::string& address, std::initializer_list<std::string> parts) {
        expect_input_error([&] { open_pose_source(address); }, parts);
    };
    refuse("vmc:", {"vmc:", "no port", "vmc:HOST:PORT"});
    refuse("vmc:port", {"vmc:port", "\"port\"", "vmc:39539"});
    refuse("udp", {"udp", "no port", "udp:PORT"});
    refuse("udp:65536", {"65536", "no port"});
    refuse("udp:-1", {"no port"});
    refuse("udp:1 ", {"no port"});
    refuse("vmc:nobody:39539", {"vmc:nobody:39539", "\"nobody\"", "127.0.0.1"});
    refuse("vmc::39539", {"no address"});
    refuse("vmc:192.0.2.1:0", {"192.0.2.1", "no address of this machine"});  // an address kept for examples
    const auto taken = open_pose_source("udp:127.0.0.1:0");
    const std::string again = fmt::format("vmc:{}", port_of(*taken));
    refuse(again, {again, fmt::format("port {} of 127.0.0.1", port_of(*taken)), "choose another port"});
    EXPECT_TRUE(open_pose_source("udp:localhost:0"));
    EXPECT_TRUE(open_pose_source("vmc:0.0.0.0:0"));
    refuse("nowhere.jsonl", {"nowhere.jsonl"});
    refuse("nowhere.glb", {"nowhere.glb"});
}

TEST(PoseSource, ListensToThisMachineAlone) {
    EXPECT_EQ(open_pose_source("udp:0")->name().find("JSON on 127.0.0.1:"), 0u);
    EXPECT_EQ(open_pose_source("vmc:0")->name().find("VMC on 127.0.0.1:"), 0u);
    EXPECT_EQ(open_pose_source("vmc:0.0.0.0:0")->name().find("VMC on 0.0.0.0:"), 0u);
}

// stdin is a pipe as long as this lives.
class PipedStdin {
  public:
    PipedStdin() : kept_(dup(STDIN_FILENO)) {
        int ends[2];
        if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
        dup2(ends[0], STDIN_FILENO);
        close(ends[0]);
        write_ = ends[1];
    }
    PipedStdin(const PipedStdin&) = delete;
    PipedStdin& operator=(const PipedStdin&) = delete;
    ~PipedStdin() {
        end();
        dup2(kept_, STDIN_FILENO);
        close(kept_);
    }
    void put(const std::string& text) const {
        if (write(write_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
            throw std::runtime_error("cannot write");
    }
    void end() {
        if (write_ >= 0) close(write_);
        write_ = -1;
    }

  private:
    int kept_, write_ = -1;
};

TEST(PoseSource, LinesOfStdinArriveWithoutWaiting) {
    PipedStdin in;
    const auto source = open_pose_source("-");
    EXPECT_EQ(source->name(), "stdin");
    EXPECT_FALSE(source->newest(0)) << "nothing is there";
    const std::string line = line_of(1, 1) + "\n";
    in.put(line.substr(0, 20));
    EXPECT_FALSE(source->newest(0.1)) << "a part of a line";
    in.put(line.substr(20) + line_of(1.1, 2) + "\r\n\n" + line_of(1.2, 3));
    EXPECT_EQ(nose_of(source->newest(0.2)), 2);
    EXPECT_EQ(source->state().poses, 2u);
    in.put("\nno pose\n");
    EXPECT_EQ(nose_of(source->newest(0.3)), 3);
    EXPECT_EQ(source->state().left_out, 1u);
    EXPECT_NE(source->state().first_error.find("stdin: line 5"), std::string::npos) << source->state().first_error;
    source->newest(1.4);
    EXPECT_TRUE(source->state().stopped);
    in.put(line_of(2.5, 4) + "\n");
    EXPECT_EQ(nose_of(source->newest(1.5)), 4);
    EXPECT_FALSE(source->state().stopped);
    in.put(line_of(2.6, 5));
    in.end();
    EXPECT_FALSE(source->newest(1.6)) << "the line may go on";
    EXPECT_EQ(nose_of(source->newest(1.7)), 5) << "a last line may lack its end";
    EXPECT_TRUE(source->state().stopped) << "the stream has ended";
}

TEST(PoseSource, ALineWithoutAnEndTakesNoMemory) {
    PipedStdin in;
    const auto source = open_pose_source("-");
    const std::string piece(1 << 15, 'x');
    struct mallinfo2 settled {};
    for (int i = 0; i < 4000; ++i) {
        in.put(piece);
        EXPECT_FALSE(source->newest(i));
        if (i == 100) settled = mallinfo2();
    }
    EXPECT_LE(mallinfo2().uordblks, settled.uordblks + 4096);
    in.put("\n" + line_of(1, 1) + "\n");
    EXPECT_EQ(nose_of(source->newest(5000)), 1);
    EXPECT_EQ(source->state().left_out, 1u) << "the long line";
}

TEST(PoseSource, LinesAreReplayedAtTheirOwnPace) {
    const TemporaryFolder folder;
    std::string lines = "no pose\n";
    for (const double time_s : {20.0, 20.1, 20.05, 20.2, 21.0}) lines += line_of(time_s, time_s) + "\n";
    write_text(folder.path / "take.jsonl", lines);
    const auto source = open_pose_source((folder.path / "take.jsonl").string());
    const auto first = source->newest(100);
    EXPECT_EQ(nose_of(first), 20) << "its pace begins with the first call";
    EXPECT_NEAR(first->time_s, 100, 1e-9);
    EXPECT_FALSE(source->newest(100.09));
    const auto second = source->newest(100.15);
    EXPECT_EQ(nose_of(second), 20.1) << "the pose at or before the time";
    EXPECT_NEAR(second->time_s, 100.1, 1e-9);
    EXPECT_FALSE(source->newest(100.19));
    EXPECT_FALSE(source->state().stopped);
    EXPECT_EQ(nose_of(source->newest(105)), 21);
    EXPECT_TRUE(source->state().stopped);
    EXPECT_EQ(source->state().poses, 4u);
    EXPECT_EQ(source->state().left_out, 2u);
    EXPECT_NE(source->state().first_error.find("line 1"), std::string::npos);
    EXPECT_FALSE(source->newest(106));
    write_text(folder.path / "empty.jsonl", "\n{}\n");
    expect_input_error([&] { open_pose_source((folder.path / "empty.jsonl").string()); },
                       {"empty.jsonl", "has no pose"});
}

TEST(PoseSource, AReplayGoesOnFromWhereItIsRewoundTo) {
    const TemporaryFolder folder;
    std::string lines;
    for (int i = 0; i < 10; ++i) lines += line_of(0.1 * i, i) + "\n";
    write_text(folder.path / "take.jsonl", lines);
    const auto source = open_pose_source((folder.path / "take.jsonl").string());
    EXPECT_EQ(nose_of(source->newest(5)), 0);
    EXPECT_EQ(nose_of(source->newest(5.95)), 9);
    EXPECT_TRUE(source->state().stopped);
    source->rewind(7, 0.4);
    EXPECT_FALSE(source->state().stopped);
    const auto pose = source->newest(7.05);
    EXPECT_EQ(nose_of(pose), 4);
    EXPECT_NEAR(pose->time_s, 7, 1e-9);
}

TEST(PoseSource, SkeletonsAreReplayed) {
    const TemporaryFolder folder;
    const motion::SkeletonClip clip = test::performer_motion(10);
    motion::write_skeleton(folder.path / "take.skeleton.glb", clip);
    const auto source = open_pose_source((folder.path / "take.skeleton.glb").string());
    source->newest(0);
    const auto pose = source->newest(4.5 / clip.fps);
    ASSERT_TRUE(pose);
    EXPECT_NEAR(pose->time_s, 4 / clip.fps, 1e-9);
    for (size_t j = 0; j < motion::kJoints; ++j)
        EXPECT_LT(glm::distance(pose->pose[j].position, clip.frames[4][j].position), 1e-4);
    EXPECT_FALSE(source->state().stopped);
    source->newest(9.01 / clip.fps);
    EXPECT_TRUE(source->state().stopped);
}

}  // namespace
}  // namespace neuvv::pose_source_test
