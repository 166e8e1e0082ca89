#include "voctree/files/nvv.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "support/input_error.h"
#include "support/nvv_bytes.h"
#include "support/random_tree.h"
#include "voctree/files/chunk_file.h"
#include "voctree/files/world_frame.h"

namespace neuvv {
namespace {

using test::Bytes;
using test::Chunk;
using test::chunks_of;
using test::nvv_of;
using test::Random;
using test::random_tree;
using test::read_bytes;
using test::write_bytes;

bool same_tree(const voctree::VOctree& a, const voctree::VOctree& b) {
    const auto same_node = [](const TreeNode& m, const TreeNode& n) {
        return m.mask_lo == n.mask_lo && m.mask_hi == n.mask_hi && m.first_child == n.first_child;
    };
    return a.box_min == b.box_min && a.box_size == b.box_size && a.node_levels == b.node_levels &&
           std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), same_node) &&
           a.children == b.children && a.leaf_count == b.leaf_count && a.bases == b.bases &&
           a.hh_degree == b.hh_degree && a.frames == b.frames && a.fps == b.fps && a.sigma_basis == b.sigma_basis &&
           a.gamma_basis == b.gamma_basis && a.weights == b.weights;
}

voctree::VOctree small_tree() {
    return random_tree({.seed = 4, .node_levels = 2, .leaves = 20, .bases = 2, .hh_degree = 1, .frames = 2});
}

class Nvv : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  ("neuvv_" + std::to_string(getpid()) + testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
        path_ = folder_ / "tree.nvv";
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    // The error message for these bytes, or an empty string.
    std::string complaint(const Bytes& bytes) {
        write_bytes(path_, bytes);
        std::vector<voctree::NvvChunk> extra;
        try {
            voctree::read_nvv(path_, &extra);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
    void expect_complaint(const std::string& words, const Bytes& bytes) {
        const std::string found = complaint(bytes);
        EXPECT_NE(std::string::npos, found.find(words)) << "expected: " << words << "\nfound: " << found;
        EXPECT_EQ(0u, found.find(path_.string())) << found;
    }

    std::filesystem::path folder_, path_;
};

TEST_F(Nvv, RoundTripOfMixedTrees) {
    for (uint32_t seed = 0; seed < 24; ++seed) {
        const voctree::VOctree tree = random_tree({.seed = seed,
                                                   .node_levels = 1 + seed % 3,
                                                   .leaves = 1 + 97 * (seed % 7),
                                                   .bases = 1 + seed,
                                                   .hh_degree = seed % 4,
                                                   .frames = 1 + seed % 5});
        voctree::write_nvv(path_, tree, {}, seed % 2 ? 1 : 9);
        ASSERT_TRUE(same_tree(tree, voctree::read_nvv(path_))) << seed;
    }
}

// A tree as training writes it: leaves use few of the bases, weights are on coarse grids or have few digits.
voctree::VOctree compact_tree(uint32_t seed) {
    voctree::VOctree tree =
        random_tree({.seed = seed, .node_levels = 2, .leaves = 120, .bases = 13, .hh_degree = 1, .frames = 13});
    Random random(seed);
    for (uint32_t i = 0; i < tree.leaf_count; ++i) {
        float* leaf = tree.leaf(i);
        for (uint32_t c = 0; c < tree.bases; ++c) {
            const bool used = random.below(4) == 0;
            leaf[c] = used ? std::ldexp(1.0f + static_cast<float>(random.below(16)) / 16, int(random.below(8)) - 2) : 0;
            leaf[tree.bases + c] = used ? static_cast<float>(int(random.below(100)) - 50) / 8 : 0;
        }
        for (uint32_t w = 2 * tree.bases; w < tree.weights_per_leaf(); ++w)
            leaf[w] = static_cast<float>(int(random.below(40)) - 20) / 4;
    }
    return tree;
}

TEST_F(Nvv, CompactTreesTakeFewBytes) {
    for (uint32_t seed = 0; seed < 8; ++seed) {
        const voctree::VOctree tree = compact_tree(seed);
        voctree::write_nvv(path_, tree, {}, 1);
        EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_))) << seed;
        EXPECT_EQ(nvv_of(chunks_of(tree)), read_bytes(path_)) << seed;
    }
    const voctree::NvvSummary summary = voctree::summarise_nvv(path_);
    const uint64_t leaves = summary.header.leaf_count;
    EXPECT_EQ(2 * leaves, summary.chunks[5].raw_bytes);
    EXPECT_LT(summary.chunks[6].raw_bytes, 13 * leaves);  // a quarter of 13 halves, plus a margin for chance
}

// Steps that exceed 16 bits wrap around, and are restored by wrapping back.
TEST_F(Nvv, StepsMayWrap) {
    voctree::VOctree tree = small_tree();
    for (uint32_t i = 0; i < tree.leaf_count; ++i) tree.leaf(i)[4] = i % 2 ? 32752.0f : -32752.0f;
    voctree::write_nvv(path_, tree, {}, 1);
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_)));
    EXPECT_EQ(nvv_of(chunks_of(tree)), read_bytes(path_));
}

TEST_F(Nvv, RemembersWhereItIsInItsCapture) {
    const voctree::VOctree tree = small_tree();
    voctree::write_nvv(path_, tree);
    EXPECT_TRUE(voctree::read_world_frame(path_).is_same());
    const Bytes plain = read_bytes(path_);
    const voctree::WorldFrame frame{{512345.125, -3, 5.4e6}, 1e-3};
    const voctree::ChunkOfFrame chunk(frame);
    voctree::write_nvv(path_, tree, chunk.views());
    EXPECT_EQ(voctree::read_world_frame(path_), frame);
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_))) << "a reader that does not know it skips it";
    voctree::write_nvv(path_, tree, voctree::ChunkOfFrame({}).views());
    EXPECT_EQ(read_bytes(path_), plain) << "usual clips are as before";
    const voctree::ChunkOfFrame bad({{0, 0, 0}, -1});
    voctree::write_nvv(path_, tree, bad.views());
    expect_input_error([&] { voctree::read_world_frame(path_); }, {path_.string(), "wRLD"});
}

TEST_F(Nvv, RoundTripBeyondOnePiece) {
    const voctree::VOctree tree =
        random_tree({.seed = 2, .node_levels = 3, .leaves = 40000, .bases = 31, .hh_degree = 2});
    voctree::write_nvv(path_, tree);
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_)));
}

TEST_F(Nvv, RoundTripOfTheEmptyTree) {
    voctree::VOctree tree = random_tree({.leaves = 0});
    ASSERT_EQ(0u, tree.leaf_count);
    tree.fps = 29.97f;
    voctree::write_nvv(path_, tree);
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_)));
}

TEST_F(Nvv, SameTreeCatchesADifference) {
    const voctree::VOctree tree = small_tree();
    voctree::VOctree other = tree;
    other.weights[7] += 1;
    EXPECT_FALSE(same_tree(tree, other));
    other = tree;
    other.nodes[0].mask_hi ^= 1;
    EXPECT_FALSE(same_tree(tree, other));
}

TEST_F(Nvv, WeightsRoundToHalfAndSaturate) {
    voctree::VOctree tree = small_tree();
    tree.leaf(0)[0] = 1e9f;
    tree.leaf(0)[1] = -1e9f;
    tree.leaf(1)[2] = 1.0f / 3;
    tree.sigma_basis[0] = 1.0f / 3;
    voctree::write_nvv(path_, tree);
    const voctree::VOctree read = voctree::read_nvv(path_);
    EXPECT_EQ(65504.0f, read.leaf(0)[0]);
    EXPECT_EQ(-65504.0f, read.leaf(0)[1]);
    EXPECT_EQ(0.333251953125f, read.leaf(1)[2]);
    EXPECT_EQ(1.0f / 3, read.sigma_basis[0]);
}

TEST_F(Nvv, ReadsWhatTheSpecificationSays) {
    const voctree::VOctree tree = random_tree({.seed = 6, .node_levels = 3, .leaves = 300, .bases = 5, .hh_degree = 2});
    write_bytes(path_, nvv_of(chunks_of(tree)));
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_)));
}

TEST_F(Nvv, WritesWhatTheSpecificationSays) {
    const voctree::VOctree tree = small_tree();
    voctree::write_nvv(path_, tree, {}, 1);
    EXPECT_EQ(nvv_of(chunks_of(tree)), read_bytes(path_));
}

TEST_F(Nvv, ExtraChunksRideAlong) {
    const voctree::VOctree tree = small_tree();
    const std::vector<voctree::NvvChunk> extra = {{"adam", Bytes(100000, 7)}, {"p4nt", {}}, {"zzzz", {1, 2, 3}}};
    voctree::write_nvv(path_, tree, {extra.begin(), extra.end()});
    std::vector<voctree::NvvChunk> read = {{"left", {1}}};
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_, &read)));
    ASSERT_EQ(extra.size(), read.size());
    for (size_t i = 0; i < extra.size(); ++i) {
        EXPECT_EQ(extra[i].name, read[i].name);
        EXPECT_EQ(extra[i].bytes, read[i].bytes);
    }
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_)));

    // Between the known chunks, too.
    std::vector<Chunk> chunks = chunks_of(tree);
    chunks.insert(chunks.begin() + 3, {.name = "note", .raw = {9}});
    write_bytes(path_, nvv_of(chunks));
    EXPECT_TRUE(same_tree(tree, voctree::read_nvv(path_, &read)));
    ASSERT_EQ(1u, read.size());
    EXPECT_EQ("note", read[0].name);
}

TEST_F(Nvv, SummaryListsChunks) {
    const voctree::VOctree tree = small_tree();
    voctree::write_nvv(path_, tree, {{"adam", Bytes(1000)}});
    const voctree::NvvSummary summary = voctree::summarise_nvv(path_);
    EXPECT_EQ(voctree::kNvvVersion, summary.version);
    EXPECT_EQ(std::filesystem::file_size(path_), summary.file_bytes);
    EXPECT_EQ(tree.leaf_count, summary.header.leaf_count);
    EXPECT_EQ(tree.box_size, summary.header.box_size);
    ASSERT_EQ(10u, summary.chunks.size());
    EXPECT_EQ("HEAD", summary.chunks[0].name);
    EXPECT_EQ(56u, summary.chunks[0].raw_bytes);
    EXPECT_EQ("adam", summary.chunks[9].name);
    EXPECT_EQ(1000u, summary.chunks[9].raw_bytes);
    uint64_t total = 12 + 32;
    for (const voctree::NvvSummary::Chunk& chunk : summary.chunks) total += 32 + chunk.stored_bytes;
    EXPECT_EQ(summary.file_bytes, total);

    std::filesystem::resize_file(path_, summary.file_bytes - 1);
    EXPECT_THROW(voctree::summarise_nvv(path_), InputError);
}

TEST_F(Nvv, FileStartsAreTold) {
    Bytes bytes = nvv_of(chunks_of(small_tree()));
    EXPECT_EQ("", complaint(bytes));
    expect_complaint("newer neuvv", nvv_of(chunks_of(small_tree()), voctree::kNvvVersion + 1));
    expect_complaint("train it again", nvv_of(chunks_of(small_tree()), voctree::kNvvVersion - 1));
    bytes.erase(bytes.begin() + 4);  // CRLF became LF
    expect_complaint("text-mode", bytes);
    bytes[0] &= 0x7f;
    expect_complaint("not an .nvv file", bytes);
    expect_complaint("not an .nvv file", {});
    EXPECT_THROW(voctree::read_nvv(folder_ / "missing.nvv"), InputError);
    EXPECT_THROW(voctree::read_nvv(folder_), InputError);
}

TEST_F(Nvv, EveryTruncationIsSeen) {
    const Bytes whole = nvv_of(chunks_of(small_tree()));
    for (size_t size = 0; size < whole.size(); ++size)
        ASSERT_NE("", complaint(Bytes(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size)))) << size;
    EXPECT_EQ("", complaint(whole));
    Bytes longer = whole;
    longer.push_back(0);
    expect_complaint("not the end", longer);
}

TEST_F(Nvv, EverySingleFlippedBitIsSeen) {
    const Bytes whole = nvv_of(chunks_of(small_tree()));
    for (size_t i = 0; i < whole.size(); ++i) {
        Bytes damaged = whole;
        damaged[i] = static_cast<uint8_t>(damaged[i] ^ 1 << i % 8);
        ASSERT_NE("", complaint(damaged)) << i;
    }
}

// Damage without valid checksums is refused, or the tree is unchanged.
TEST_F(Nvv, FuzzOfBytesAndChunks) {
    const voctree::VOctree tree = small_tree();
    std::vector<Chunk> chunks = chunks_of(tree);
    chunks.push_back({.name = "adam", .raw = Bytes(50, 3)});
    const Bytes whole = nvv_of(chunks);
    std::vector<std::pair<size_t, size_t>> spans;  // of the chunks in `whole`
    for (size_t at = 12; at < whole.size();) {
        uint64_t stored = 0;
        std::memcpy(&stored, &whole[at + 16], 8);
        spans.emplace_back(at, at + 32 + stored);
        at += 32 + stored;
    }
    ASSERT_EQ(11u, spans.size());

    Random random(11);
    int refused = 0;
    const auto offset = [](size_t at) { return static_cast<ptrdiff_t>(at); };
    for (int round = 0; round < 8000; ++round) {
        Bytes bytes = whole;
        for (uint32_t edits = 1 + random.below(3); edits > 0; --edits) {
            const size_t at = random.below(bytes.size());
            const size_t length = std::min<size_t>(1 + random.below(random.below(4) ? 4 : 200), bytes.size() - at);
            const uint32_t kind = random.below(5);
            if (kind == 0) bytes[at] = static_cast<uint8_t>(random.below(256));
            if (kind == 1) bytes.insert(bytes.begin() + offset(at), length, static_cast<uint8_t>(random.below(256)));
            if (kind == 2 && length < bytes.size())
                bytes.erase(bytes.begin() + offset(at), bytes.begin() + offset(at + length));
            if (kind == 3) std::fill_n(bytes.begin() + offset(at), length, static_cast<uint8_t>(random.below(2) * 255));
            if (kind == 4) {  // the chunks in another order, perhaps with one twice or missing
                bytes.resize(12);
                std::vector<std::pair<size_t, size_t>> shuffled = spans;
                std::swap(shuffled[random.below(11)], shuffled[random.below(11)]);
                shuffled[random.below(11)] = shuffled[random.below(11)];
                for (const auto& [begin, end] : shuffled)
                    bytes.insert(bytes.end(), whole.begin() + offset(begin), whole.begin() + offset(end));
            }
        }
        write_bytes(path_, bytes);
        try {
            std::vector<voctree::NvvChunk> extra;
            ASSERT_TRUE(same_tree(tree, voctree::read_nvv(path_, &extra))) << round;
            ASSERT_EQ(bytes, whole) << round;
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 5000);
}

// Damage with valid checksums is refused, or gives a tree without defects, each leaf of which can be found.
TEST_F(Nvv, FuzzOfContentUnderValidChecksums) {
    Random random(12);
    int refused = 0, accepted = 0;
    for (int round = 0; round < 8000; ++round) {
        std::vector<Chunk> chunks = chunks_of(
            random_tree({.seed = 50 + random.below(20), .node_levels = 2, .leaves = 12, .bases = 2, .hh_degree = 0}));
        for (uint32_t edits = 1 + random.below(2); edits > 0; --edits) {
            Chunk& chunk = chunks[random.below(chunks.size())];
            const size_t at = random.below(chunk.raw.size());
            const uint32_t kind = random.below(8);
            if (kind == 0) chunk.raw.resize(at);
            if (kind == 1) chunk.raw.insert(chunk.raw.begin() + static_cast<ptrdiff_t>(at), 4, 0);
            if (kind == 2) chunk.claimed_raw_bytes = random.engine() >> random.below(64);
            if (kind == 3) std::swap(chunk, chunks[random.below(chunks.size())]);
            if (kind >= 4 && at < chunk.raw.size())
                chunk.raw[at] = static_cast<uint8_t>(kind == 4 ? 255 : chunk.raw[at] ^ 1 << random.below(8));
            if (chunk.raw.empty()) chunk.raw.push_back(0);
        }
        write_bytes(path_, nvv_of(chunks));
        try {
            const voctree::VOctree tree = voctree::read_nvv(path_);
            ASSERT_EQ("", voctree::defect_of(tree)) << round;
            ASSERT_EQ(tree.leaf_count, voctree::leaf_positions(tree).size());
            for (int i = 0; i < 20; ++i) {
                const uint32_t leaf = voctree::find_leaf(tree, {random.uniform(), random.uniform(), random.uniform()});
                ASSERT_TRUE(leaf == UINT32_MAX || leaf < tree.leaf_count) << round;
            }
            ++accepted;
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 1500);  // both outcomes are frequent
    EXPECT_GT(accepted, 1500);
}

TEST_F(Nvv, HostileTrees) {
    const auto file_with = [](const std::function<void(voctree::VOctree&)>& damage) {
        voctree::VOctree tree = small_tree();
        damage(tree);
        return nvv_of(chunks_of(tree));
    };
    const auto node_entry = [](voctree::VOctree& tree) -> uint32_t& {
        for (uint32_t& entry : tree.children)
            if (!(entry & kLeafBit)) return entry;
        throw std::logic_error("the tree has one node only");
    };
    EXPECT_EQ("", complaint(file_with([](voctree::VOctree&) {})));
    expect_complaint("chunk CHLD: node 0: node 0 is reached more than once",
                     file_with([&](voctree::VOctree& t) { node_entry(t) = 0; }));
    expect_complaint("out of range", file_with([&](voctree::VOctree& t) { node_entry(t) = 0x7fffffff; }));
    expect_complaint("out of range", file_with([&](voctree::VOctree& t) { node_entry(t) = UINT32_MAX; }));
    expect_complaint("beyond the child array",
                     file_with([](voctree::VOctree& t) { t.nodes[0].first_child = UINT32_MAX; }));
    expect_complaint("box", file_with([](voctree::VOctree& t) { t.box_size.x = std::nanf(""); }));
    expect_complaint("fps", file_with([](voctree::VOctree& t) { t.fps = -1; }));
    expect_complaint("weights: number 5 is not finite",
                     file_with([](voctree::VOctree& t) { t.weights[5] = std::nanf(""); }));
    expect_complaint("gamma basis",
                     file_with([](voctree::VOctree& t) { t.gamma_basis[1] = std::numeric_limits<float>::infinity(); }));
    expect_complaint("node_levels", file_with([](voctree::VOctree& t) { t.node_levels = 7; }));
    expect_complaint("deeper", file_with([](voctree::VOctree& t) { t.node_levels = 1; }));
}

TEST_F(Nvv, HostileCounts) {
    const char* names[] = {"node_levels", "node_count", "child_count", "leaf_count", "bases", "hh_degree", "frames"};
    for (size_t field = 0; field < std::size(names); ++field) {
        for (const uint32_t count : {UINT32_MAX, 0x80000000u, 0x7fffffffu}) {
            std::vector<Chunk> chunks = chunks_of(small_tree());
            std::memcpy(&chunks[0].raw[4 * field], &count, 4);
            expect_complaint(std::string("chunk HEAD: ") + names[field], nvv_of(chunks));
        }
    }
    // The largest counts that HEAD may have, without the data that they need.
    for (const auto& [field, count] :
         {std::pair<size_t, uint32_t>{1, voctree::kMaxNodes}, {2, 8 * voctree::kMaxLeaves}}) {
        std::vector<Chunk> chunks = chunks_of(small_tree());
        std::memcpy(&chunks[0].raw[4 * field], &count, 4);
        expect_complaint("bytes, not the", nvv_of(chunks));
        chunks[field].claimed_raw_bytes = (field == 1 ? 12 : 4) * uint64_t{count};
        expect_complaint("too many for a file of", nvv_of(chunks));
    }
    // Leaves that no node reaches are refused before memory is allocated for their weights.
    std::vector<Chunk> chunks = chunks_of(small_tree());
    std::memcpy(&chunks[0].raw[12], &voctree::kMaxLeaves, 4);
    expect_complaint("leaves are not reached", nvv_of(chunks));
}

// Weights that need no bytes in the file still need memory.
TEST_F(Nvv, EmptyLeavesMayNotAskForMemoryWithoutEnd) {
    voctree::VOctree tree = random_tree({.leaves = 1, .bases = 1, .hh_degree = 0});
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < 64 * 64 * 64; ++i) positions.push_back({i % 64, i / 64 % 64, i / 4096, 6});
    tree.node_levels = 3;
    voctree::build_topology(tree, positions);
    std::vector<Chunk> chunks = chunks_of(tree);
    EXPECT_EQ("", complaint(nvv_of(chunks)));
    const uint32_t bases = 64, hh_degree = 3;  // 436 bytes a leaf as halves, 114 MB in all
    std::memcpy(&chunks[0].raw[16], &bases, 4);
    std::memcpy(&chunks[0].raw[20], &hh_degree, 4);
    chunks[3].raw = chunks[4].raw = Bytes(4 * bases * tree.frames);
    chunks[5].raw = Bytes(size_t{8} * tree.leaf_count);
    expect_complaint("chunk MASK: claims 114294784 bytes, too many for a file of", nvv_of(chunks));
}

TEST_F(Nvv, HostileChunks) {
    const std::vector<Chunk> good = chunks_of(small_tree());
    const auto file_with = [&](const std::function<void(std::vector<Chunk>&)>& damage) {
        std::vector<Chunk> chunks = good;
        damage(chunks);
        return nvv_of(chunks);
    };
    using Chunks = std::vector<Chunk>;
    const auto lie = [](Chunk& chunk, size_t more) {
        chunk.claimed_raw_bytes = chunk.raw.size();
        chunk.stored = test::compressed(Bytes(chunk.raw.size() + more, 1));
    };
    // Raw sizes that differ from the size of the unpacked frame, too small and too large.
    expect_complaint("cannot be unpacked", file_with([&](Chunks& c) { lie(c[5], 1); }));
    expect_complaint("unpacks to", file_with([&](Chunks& c) { lie(c[5], size_t(-1)); }));
    expect_complaint("too many for a file", file_with([](Chunks& c) { c[5].claimed_raw_bytes = UINT64_MAX; }));
    expect_complaint("too many for a file",
                     file_with([](Chunks& c) { c.push_back({.name = "bomb", .raw = Bytes(size_t{80} << 20)}); }));
    expect_complaint("not one zstd frame", file_with([](Chunks& c) { c[3].stored = Bytes{}; }));
    expect_complaint("not one zstd frame", file_with([](Chunks& c) { c[3].stored = Bytes(40, 'x'); }));
    expect_complaint("not one zstd frame", file_with([](Chunks& c) {
                         c[3].stored = test::compressed(c[3].raw);
                         c[3].stored->push_back(0);
                     }));
    expect_complaint("newer neuvv", file_with([](Chunks& c) { c[4].flags = 1; }));
    expect_complaint("chunk PLUS: is unknown", file_with([](Chunks& c) { c.push_back({.name = "PLUS", .raw = {}}); }));
    expect_complaint("chunk MASK: names a basis that does not exist", file_with([](Chunks& c) { c[5].raw[3] |= 4; }));
    for (const uint8_t coding : Bytes{25, 127, 144, 255})
        expect_complaint("chunk WGAM: has a column of unknown coding",
                         file_with([&](Chunks& c) { c[7].raw[1] = coding; }));
    expect_complaint("appears twice", file_with([](Chunks& c) { c.push_back(c[8]); }));
    expect_complaint("is where chunk HEAD must be", file_with([](Chunks& c) { c.insert(c.begin(), {"note", {}}); }));
    expect_complaint("is where chunk NODE must be", file_with([](Chunks& c) { std::swap(c[1], c[2]); }));
    expect_complaint("comes before chunk WHHC", file_with([](Chunks& c) { c.pop_back(); }));
    expect_complaint("no chunk starts here",
                     file_with([](Chunks& c) { c.push_back({.name = "a\n\x1b!", .raw = {}}); }));
    expect_complaint(
        "one too many", file_with([](Chunks& c) {
            for (char i = 0; i < 26; ++i)
                for (char j = 0; j < 10; ++j)
                    c.push_back(
                        {.name = {'x', static_cast<char>('a' + i), static_cast<char>('0' + j), 'x'}, .raw = {}});
        }));
}

}  // namespace
}  // namespace neuvv
