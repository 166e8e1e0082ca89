// A file is written whole or not at all.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>

#include "base/error.h"
#include "support/nvv_bytes.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/nvv.h"

namespace neuvv {
namespace {

voctree::VOctree an_old_tree() {
    return test::random_tree({.seed = 4, .node_levels = 2, .leaves = 20, .bases = 2, .hh_degree = 1, .frames = 2});
}

class NvvAtomic : public testing::Test {
  protected:
    void SetUp() override {
        voctree::write_nvv(path_, an_old_tree());
        old_ = test::read_bytes(path_);
    }
    void expect_old_file_alone() {
        EXPECT_EQ(old_, test::read_bytes(path_));
        EXPECT_EQ(folder_.entries(), 1u);
    }
    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path / "tree.nvv";
    test::Bytes old_;
};

TEST_F(NvvAtomic, FoldersThatTakeNoFile) {
    EXPECT_THROW(voctree::write_nvv(folder_.path / "missing" / "tree.nvv", an_old_tree()), RuntimeFailure);
    EXPECT_THROW(voctree::write_nvv(path_ / "below_a_file.nvv", an_old_tree()), RuntimeFailure);
    EXPECT_THROW(voctree::write_nvv("/proc/tree.nvv", an_old_tree()), RuntimeFailure);  // not writable even for root
    expect_old_file_alone();
}

TEST_F(NvvAtomic, ADiskThatFillsUpLeavesTheOldFile) {
    const voctree::VOctree large = test::random_tree({.node_levels = 3, .leaves = 3000, .bases = 31, .hh_degree = 2});
    struct rlimit before {};
    ASSERT_EQ(0, getrlimit(RLIMIT_FSIZE, &before));
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit small = before;
    small.rlim_cur = 100'000;
    ASSERT_EQ(0, setrlimit(RLIMIT_FSIZE, &small));
    EXPECT_THROW(voctree::write_nvv(path_, large), RuntimeFailure);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    expect_old_file_alone();
    voctree::write_nvv(path_, large);
    EXPECT_EQ(large.weights, voctree::read_nvv(path_).weights);
}

TEST_F(NvvAtomic, WhatReadersRefuseIsNotWritten) {
    voctree::VOctree diverged = an_old_tree();
    diverged.weights[0] = std::nanf("");
    EXPECT_THROW(voctree::write_nvv(path_, diverged), RuntimeFailure);
    for (const char* name : {"PLUS", "ab", "abcde", "a b1", "1abc", ""})
        EXPECT_THROW(voctree::write_nvv(path_, an_old_tree(), {{name, {}}}), RuntimeFailure) << name;
    EXPECT_THROW(voctree::write_nvv(path_, an_old_tree(), {{"twin", {}}, {"twin", {}}}), RuntimeFailure);
    EXPECT_THROW(voctree::write_nvv(path_, an_old_tree(), {{"zero", test::Bytes(size_t{80} << 20)}}), RuntimeFailure);
    expect_old_file_alone();
}

}  // namespace
}  // namespace neuvv
