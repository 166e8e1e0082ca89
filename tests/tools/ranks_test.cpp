// What mpirun and srun say in the environment.
#include "tools/ranks.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

#include "base/error.h"

namespace neuvv {
namespace {

constexpr const char* kVariables[] = {"OMPI_COMM_WORLD_RANK",
                                      "OMPI_COMM_WORLD_SIZE",
                                      "OMPI_COMM_WORLD_LOCAL_RANK",
                                      "OMPI_COMM_WORLD_LOCAL_SIZE",
                                      "SLURM_STEP_NUM_NODES",
                                      "PMIX_NAMESPACE",
                                      "SLURM_PROCID",
                                      "SLURM_STEP_NUM_TASKS",
                                      "SLURM_LOCALID",
                                      "SLURM_JOB_ID",
                                      "SLURM_STEP_ID",
                                      "SLURM_RESTART_COUNT"};

struct RanksOf : testing::Test {
    std::map<std::string, std::string> before;

    void SetUp() override {
        for (const char* name : kVariables) {
            if (const char* value = std::getenv(name)) before[name] = value;
            unsetenv(name);
        }
    }
    void TearDown() override {
        for (const char* name : kVariables) unsetenv(name);
        for (const auto& [name, value] : before) setenv(name.c_str(), value.c_str(), 1);
    }
    static tools::Ranks ranks(const std::map<std::string, std::string>& environment) {
        for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
        return tools::ranks_of_environment();
    }
};

TEST_F(RanksOf, AProgramStartedAlone) {
    const tools::Ranks one = ranks({});
    EXPECT_EQ(one.count, 1u);
    EXPECT_TRUE(one.is_first());
    EXPECT_EQ(ranks({{"SLURM_PROCID", "0"}, {"SLURM_JOB_ID", "7"}}).count, 1u) << "a batch script itself";
}

TEST_F(RanksOf, OpenMpi) {
    const tools::Ranks third = ranks({{"OMPI_COMM_WORLD_RANK", "2"},
                                      {"OMPI_COMM_WORLD_SIZE", "4"},
                                      {"OMPI_COMM_WORLD_LOCAL_RANK", "1"},
                                      {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"},
                                      {"PMIX_NAMESPACE", "77"}});
    EXPECT_EQ(third.rank, 2u);
    EXPECT_EQ(third.count, 4u);
    EXPECT_EQ(third.local, 1u);
    EXPECT_EQ(third.on_machine, 2u);
    EXPECT_EQ(third.job, "77.");
    EXPECT_FALSE(third.is_first());
    EXPECT_EQ(tools::device_of_rank(third, "some device"), "some device");
}

TEST_F(RanksOf, Slurm) {
    const tools::Ranks first = ranks({{"SLURM_PROCID", "0"},
                                      {"SLURM_STEP_NUM_TASKS", "2"},
                                      {"SLURM_STEP_NUM_NODES", "1"},
                                      {"SLURM_LOCALID", "0"},
                                      {"SLURM_JOB_ID", "12"},
                                      {"SLURM_STEP_ID", "3"}});
    EXPECT_TRUE(first.is_first());
    EXPECT_EQ(first.count, 2u);
    EXPECT_EQ(first.on_machine, 2u);
    EXPECT_NE(first.job, ranks({{"SLURM_RESTART_COUNT", "1"}}).job) << "a step that was queued again is another start";
}

TEST_F(RanksOf, NumbersThatMakeNoSense) {
    EXPECT_THROW(ranks({{"OMPI_COMM_WORLD_RANK", "4"}, {"OMPI_COMM_WORLD_SIZE", "4"}}), InputError);
    EXPECT_THROW(ranks({{"OMPI_COMM_WORLD_RANK", "-1"}}), InputError);
    EXPECT_THROW(ranks({{"OMPI_COMM_WORLD_RANK", "0"}, {"OMPI_COMM_WORLD_SIZE", "0"}}), InputError);
    EXPECT_THROW(ranks({{"OMPI_COMM_WORLD_SIZE", "99999999999"}}), InputError);
}

}  // namespace
}  // namespace neuvv
