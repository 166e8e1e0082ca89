// The memory that nested control groups leave, in folders as Linux, Docker and Slurm show them.
#include "base/memory_group.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace neuvv {
namespace {

constexpr const char* kMounted2 = "31 23 0:28 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw,nsdelegate\n";
constexpr const char* kMounted1 =
    "30 23 0:27 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu\n"
    "35 31 0:32 / /sys/fs/cgroup/memory rw,relatime - cgroup cgroup rw,memory\n";

struct MemoryGroup : testing::Test {
    TemporaryFolder root;

    void process(const std::string& mounts, const std::string& groups) const {
        write_text(root.path / "proc/self/mountinfo", "22 1 8:1 / / rw - ext4 /dev/sda1 rw\n" + mounts);
        write_text(root.path / "proc/self/cgroup", groups);
    }
    void group(const std::string& folder, const std::string& file, const std::string& text) const {
        write_text(root.path / "sys/fs/cgroup" / folder / file, text + "\n");
    }
    std::optional<uint64_t> left() const { return memory_left_by_groups(root.path); }
};

TEST_F(MemoryGroup, OfVersion2TheLeastOfAllAroundCounts) {
    process(kMounted2, "0::/system.slice/slurmstepd.scope/job_7/step_0/user/task_0\n");
    group("system.slice/slurmstepd.scope/job_7/step_0/user/task_0", "memory.max", "max");
    EXPECT_EQ(left(), std::nullopt);
    group("system.slice/slurmstepd.scope/job_7", "memory.max", "1000000");
    group("system.slice/slurmstepd.scope/job_7", "memory.current", "300000");
    group("system.slice/slurmstepd.scope/job_7", "memory.stat", "anon 200000\nfile 100000\ninactive_file 100000");
    EXPECT_EQ(left(), 800000u) << "cached files can be dropped";
    group("system.slice/slurmstepd.scope/job_7/step_0", "memory.high", "500000");
    group("system.slice/slurmstepd.scope/job_7/step_0", "memory.current", "200000");
    EXPECT_EQ(left(), 300000u) << "above it, the process would be slowed down";
    group("system.slice", "memory.max", "100");
    group("system.slice", "memory.current", "200");
    EXPECT_EQ(left(), 0u) << "more than it allows";
}

TEST_F(MemoryGroup, OfVersion1TheGroupOfMemoryCounts) {
    process(kMounted1, "4:cpu:/elsewhere\n3:memory:/slurm/uid_0/job_7\n0::/\n");
    group("memory/slurm/uid_0/job_7", "memory.limit_in_bytes", "9223372036854771712");
    EXPECT_EQ(left(), std::nullopt);
    group("memory/slurm", "memory.limit_in_bytes", "300000000");
    group("memory/slurm", "memory.usage_in_bytes", "100000000");
    group("memory/slurm", "memory.stat", "inactive_file 7\ntotal_inactive_file 50000000");
    EXPECT_EQ(left(), 250000000u);
    group("cpu/elsewhere", "memory.limit_in_bytes", "1");
    EXPECT_EQ(left(), 250000000u);
}

// Where both are mounted, each may limit.
TEST_F(MemoryGroup, BothVersionsMayBeThere) {
    process(std::string(kMounted1) + "41 31 0:38 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw\n",
            "3:memory:/a\n0::/b\n");
    group("memory/a", "memory.limit_in_bytes", "3000");
    EXPECT_EQ(left(), 3000u);
    group("unified/b", "memory.max", "2000");
    EXPECT_EQ(left(), 2000u);
}

// A container without a namespace of groups sees its own group as the root, named as the machine names it.
TEST_F(MemoryGroup, AContainersOwnGroupMayBeTheRoot) {
    process("31 23 0:28 /docker/4f1c /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory\n", "3:memory:/docker/4f1c\n");
    group("memory", "memory.limit_in_bytes", "5000");
    EXPECT_EQ(left(), 5000u);
    process("31 23 0:28 /docker/4f1c /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory\n",
            "3:memory:/docker/4f1c/inner\n");
    group("memory/inner", "memory.limit_in_bytes", "4000");
    EXPECT_EQ(left(), 4000u);
    process(kMounted2, "0::/../other\n");
    group("", "memory.max", "6000");
    EXPECT_EQ(left(), 6000u) << "a group outside of what is mounted";
    process(kMounted2, "");
    EXPECT_EQ(left(), std::nullopt);
    process("nonsense - \n\n", "nonsense\n");
    EXPECT_EQ(left(), std::nullopt);
}

TEST(AvailableMemory, IsSomeAndNotMoreThanGroupsLeave) {
    EXPECT_GT(available_memory_bytes(), 0u);
    EXPECT_LT(available_memory_bytes(), UINT64_MAX);
}

}  // namespace
}  // namespace neuvv
