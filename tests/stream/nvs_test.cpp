// Streams on the disk, and slices as trees.
#include "stream/transport/nvs_reader.h"
#include "stream/transport/nvs_writer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <thread>

#include "reference/slice.h"
#include "stream/random_slice.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_box.h"
#include "voctree/files/world_frame.h"
#include "voctree/temporal_basis.h"
#include "voctree/tree_slice.h"

namespace neuvv::test::nvs_test {
namespace {

using stream::QuantisedSlice;

struct NvsTest : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path path = folder.path / "show.nvs";
    voctree::VOctree tree = random_tree({.leaves = 300, .frames = 7});
    std::vector<QuantisedSlice> decoded;  // by the encoder

    void SetUp() override { write(path); }
    // Groups of three frames.
    void write(const std::filesystem::path& to, const stream::CaptureFrame& capture = {}) {
        stream::Steps steps;
        steps.fill(8);
        stream::Writer writer(to, 12.5f, 7, 3, capture);
        decoded.clear();
        for (uint32_t first = 0; first < 7; first += 3) {
            std::vector<stream::FrameSymbols> frames;
            for (uint32_t i = first; i < std::min(first + 3, 7u); ++i) {
                QuantisedSlice one;
                const QuantisedSlice last = slice::quantised(voctree::slice_of(tree, i > first ? i - 1 : i));
                std::optional<stream::FrameBefore> before;
                if (i > first) before.emplace(stream::FrameBefore{last, decoded.back()});
                frames.push_back(stream::encode(slice::quantised(voctree::slice_of(tree, i)), steps, before, one));
                decoded.push_back(std::move(one));
            }
            stream::Group group;
            group.format = {2 * tree.node_levels, tree.hh_degree, tree.leaf_count};
            for (int axis = 0; axis < 3; ++axis) {
                group.box_min[static_cast<size_t>(axis)] = tree.box_min[axis];
                group.box_size[static_cast<size_t>(axis)] = tree.box_size[axis];
            }
            if (first > 0)
                group.filled =
                    stream::BoxPart{{0.25f, 0, 0.5f}, {0.75f, 1, 0.5f + 0.0625f * static_cast<float>(first)}};
            writer.add(group, frames);
        }
        EXPECT_FALSE(std::filesystem::exists(to)) << "not before it is finished";
        const uint64_t bytes = writer.finish();
        EXPECT_EQ(bytes, std::filesystem::file_size(to));
    }
    std::string bytes() const {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    void overwrite(const std::string& bytes) const { std::ofstream(path, std::ios::binary) << bytes; }
};

// Bytes of a header with three groups: before the groups, of one, and what version 3 added at its end.
constexpr size_t kBeforeGroups = 32, kOfGroup = 88, kOfFilled = 24;

void set_number(std::string& bytes, size_t at, uint64_t number, size_t size) {
    for (size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<char>(number >> 8 * i);
}

void set_check(std::string& bytes, size_t header_size) {
    const auto* begin = reinterpret_cast<const uint8_t*>(bytes.data());
    set_number(bytes, header_size - 4, stream::check_of({begin, header_size - 4}), 4);
}

TEST_F(NvsTest, SaysWhatItsLeavesFill) {
    const stream::Index index = stream::Reader(path).index();
    EXPECT_EQ(index.groups[0].filled->low, (std::array<float, 3>{0, 0, 0}));
    EXPECT_EQ(index.groups[0].filled->high, (std::array<float, 3>{1, 1, 1})) << "who does not say it means all";
    EXPECT_EQ(index.groups[1].filled->low, (std::array<float, 3>{0.25f, 0, 0.5f}));
    EXPECT_EQ(index.groups[2].filled->high, (std::array<float, 3>{0.75f, 1, 0.875f}));
    const auto [low, high] = voctree::occupied_box(voctree::read_clip_index(path));
    EXPECT_EQ(glm::vec3(low), tree.box_min);
    EXPECT_EQ(glm::vec3(high), tree.box_min + tree.box_size);
    const std::string sound = bytes();
    for (const float wrong : {-0.1f, 0.75f, 0.8f, 1.1f, std::nanf("")}) {  // beyond the box, or the other corner
        std::string damaged = sound;
        set_number(damaged, kBeforeGroups + 2 * kOfGroup - kOfFilled, std::bit_cast<uint32_t>(wrong), 4);
        set_check(damaged, stream::header_bytes(3, 7));
        overwrite(damaged);
        expect_input_error([&] { stream::Reader reader(path); }, {"the group of frame 3", "leaves in a box"});
    }
}

TEST_F(NvsTest, FilesOfVersion2AreReadAsBefore) {
    std::string old = bytes();
    const stream::Index index = stream::Reader(path).index();
    set_number(old, 8, 2, 4);
    for (size_t group = 3; group-- > 0;) {
        const size_t begin = kBeforeGroups + group * kOfGroup;
        set_number(old, begin + 40, index.groups[group].offset - 3 * kOfFilled, 8);
        old.erase(begin + kOfGroup - kOfFilled, kOfFilled);
    }
    set_check(old, stream::header_bytes(3, 7) - 3 * kOfFilled);
    overwrite(old);
    stream::Reader reader(path);
    for (const stream::Group& group : reader.index().groups) EXPECT_FALSE(group.filled);
    for (uint32_t frame = 0; frame < 7; ++frame) EXPECT_EQ(reader.frame(frame)->planes, decoded[frame].planes);
    const auto [low, high] = voctree::occupied_box(voctree::read_clip_index(path));
    EXPECT_TRUE(glm::all(glm::lessThan(low, high)));
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(glm::vec3(low), tree.box_min)));
}

TEST_F(NvsTest, FramesComeBackInAnyOrder) {
    stream::Reader reader(path);
    EXPECT_EQ(reader.index().fps, 12.5f);
    ASSERT_EQ(reader.index().frames.size(), 7u);
    for (const uint32_t frame : {0u, 1u, 2u, 3u, 6u, 5u, 5u, 1u, 4u}) {
        const auto slice = reader.frame(frame);
        EXPECT_EQ(slice->leaves, decoded[frame].leaves) << frame;
        EXPECT_EQ(slice->planes, decoded[frame].planes) << frame;
    }
    const auto coarse = reader.frame(4, stream::kCoarse);
    EXPECT_EQ(coarse->leaves, decoded[4].leaves);
    EXPECT_NE(coarse->planes, decoded[4].planes);
    EXPECT_EQ(reader.frame(4)->planes, decoded[4].planes);
}

TEST_F(NvsTest, RemembersWhereItIsInItsCapture) {
    using voctree::WorldFrame;
    const std::string plain = bytes();
    EXPECT_TRUE(voctree::read_world_frame(path).is_same());
    for (const WorldFrame& frame : {WorldFrame{{512350, 410, -5403210}, 1}, WorldFrame{{0, 0, 0}, 1e-5},
                                    WorldFrame{{-0.03, 6.4e6, 0.07}, 0.01}, WorldFrame{{-6e12 / 100, 0, 0}, 1000}}) {
        std::filesystem::remove(path);
        write(path, voctree::frame_for_stream(frame, "a.nvv"));
        EXPECT_EQ(voctree::read_world_frame(path), frame);
        std::string same = bytes();  // but for what readers that do not know it ignore
        ASSERT_EQ(same.size(), plain.size());
        constexpr size_t kInHead = 24, kInGroup = kBeforeGroups + 56;
        for (const size_t at : {kInHead, kInGroup}) same.replace(at, 8, plain, at, 8);
        const size_t check = stream::header_bytes(3, 7) - 4;
        same.replace(check, 4, plain, check, 4);
        EXPECT_EQ(same, plain);
    }
    expect_input_error([] { voctree::frame_for_stream({{512345.125, -3, 5.4e6}, 1}, "a.nvv"); }, {"a.nvv", "origin"});
    expect_input_error([] { voctree::frame_for_stream({{0, 0, 0}, 0.3}, "a.nvv"); }, {"a.nvv", "unit"});
    for (const stream::CaptureFrame& wrong : {stream::CaptureFrame{{0, 0, 1}, 13, 0}, {{0, -2, 0}, 12, 0}}) {
        std::filesystem::remove(path);
        write(path, wrong);
        expect_input_error([&] { voctree::read_world_frame(path); }, {path.string(), "place of a capture"});
    }
}

// Frames of which half stays: each needs the one before.
QuantisedSlice half_changed(const QuantisedSlice& slice, uint32_t frame) {
    QuantisedSlice changed = slice;
    for (size_t i = frame % 2 ? 0 : slice.leaves.size() / 2; i < slice.leaves.size() / (frame % 2 ? 2 : 1); ++i)
        for (auto& plane : changed.planes) plane[i] = static_cast<int16_t>((plane[i] + 97 * frame) % 900);
    return changed;
}

// Calls is_right(frame) for frames in random order, on four threads. Returns how often it was false.
size_t count_wrong(uint32_t frames, const std::function<bool(uint32_t)>& is_right) {
    std::atomic<size_t> wrong = 0;
    std::vector<std::thread> threads;
    for (uint32_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            Random random(t);
            for (int i = 0; i < 100; ++i) wrong += is_right(static_cast<uint32_t>(random.below(frames))) ? 0 : 1;
        });
    for (std::thread& thread : threads) thread.join();
    return wrong;
}

// Frames of several key frames, of which one may be damaged: that is told each time, and the others are decoded.
TEST_F(NvsTest, ThreadsReadFramesOfSeveralKeyFrames) {
    std::string damaged = bytes();
    const stream::Index index = stream::Reader(path).index();
    damaged[index.place_of(4, stream::kShape).offset] ^= 1;
    for (const bool is_sound : {true, false}) {
        if (!is_sound) overwrite(damaged);
        stream::Reader reader(path);
        const size_t wrong = count_wrong(7, [&](uint32_t frame) {
            const bool fails = !is_sound && frame >= 4 && index.key_of(frame) <= 4;
            try {
                return reader.frame(frame)->planes == decoded[frame].planes && !fails;
            } catch (const InputError&) {
                return fails;
            }
        });
        EXPECT_EQ(wrong, 0u) << (is_sound ? "sound" : "damaged");
    }
}

TEST_F(NvsTest, ThreadsReadFramesThatNeedEachOther) {
    constexpr uint32_t kFrames = 60;
    stream::Steps steps;
    steps.fill(8);
    std::vector<stream::FrameSymbols> frames;
    std::vector<QuantisedSlice> shown;
    QuantisedSlice last;
    for (uint32_t i = 0; i < kFrames; ++i) {
        const QuantisedSlice slice = i == 0 ? random_slice(1, 6, 900, 1) : half_changed(last, i);
        std::optional<stream::FrameBefore> before;
        if (i > 0) before.emplace(stream::FrameBefore{last, shown.back()});
        QuantisedSlice one;
        frames.push_back(stream::encode(slice, steps, before, one));
        shown.push_back(std::move(one));
        last = slice;
    }
    for (const uint32_t most_leaves : {2000u, 1u << 24}) {  // of large frames, fewer are kept
        stream::Writer writer(path, 25, kFrames, 1);
        stream::Group group;
        group.format = {6, 1, most_leaves};
        writer.add(group, frames);
        writer.finish();
        stream::Reader reader(path);
        size_t keys = 0;
        for (const stream::FrameEntry& frame : reader.index().frames) keys += frame.is_key ? 1 : 0;
        ASSERT_EQ(keys, 1u);
        EXPECT_EQ(reader.frame(kFrames - 1)->planes, shown.back().planes) << "far behind the key frame";
        const size_t wrong =
            count_wrong(kFrames, [&](uint32_t frame) { return reader.frame(frame)->planes == shown[frame].planes; });
        EXPECT_EQ(wrong, 0u);
    }
}

// What shows less stands together.
TEST_F(NvsTest, APrefixOfAGroupHasThePartsOfItsFrames) {
    const stream::Index index = stream::Reader(path).index();
    for (uint32_t group = 0; group < 3; ++group) {
        const stream::Group& one = index.groups[group];
        uint64_t next = one.offset + one.table_bytes;
        for (uint32_t part = 0; part < stream::kParts; ++part) {
            for (uint32_t frame = one.first; frame < one.first + one.frames; ++frame) {
                EXPECT_EQ(index.place_of(frame, static_cast<stream::Part>(part)).offset, next);
                next += index.frames[frame].bytes[part];
            }
            EXPECT_EQ(index.place_of_group(group, static_cast<stream::Part>(part)).end(), next);
        }
    }
}

TEST_F(NvsTest, DamageIsNamed) {
    const std::string sound = bytes();
    const auto expect_refused = [&](const std::string& damaged, std::initializer_list<std::string> parts) {
        overwrite(damaged);
        expect_input_error(
            [&] {
                stream::Reader reader(path);
                for (uint32_t i = 0; i < 7; ++i) reader.frame(i);
            },
            parts);
    };
    expect_refused("", {"show.nvs", "no stream"});
    expect_refused(sound.substr(0, 20), {"show.nvs", "the header"});
    expect_refused(sound.substr(0, 200), {"show.nvs", "the index"});
    expect_refused(sound.substr(0, sound.size() - 1), {"show.nvs", "bytes"});
    expect_refused(sound + "x", {"show.nvs", "bytes"});
    std::string other = sound;
    other[8] = 4;
    expect_refused(other, {"version 4", "newer neuvv"});
    other[8] = 1;
    expect_refused(other, {"version 1", "publish the clip again"});
    other = sound;
    other[100] ^= 1;
    expect_refused(other, {"the index", "damaged"});
    // The last frame of the last group, and that group's tables.
    other = sound;
    other.back() = static_cast<char>(other.back() ^ 1);
    expect_refused(other, {"frame 6", "damaged"});
    overwrite(sound);
    const stream::Index index = stream::Reader(path).index();
    other = sound;
    other[index.groups[2].offset] ^= 1;
    expect_refused(other, {"the tables of frame 6", "damaged"});
    other = sound;
    other[index.place_of(3, stream::kShape).offset] ^= 1;
    overwrite(other);
    stream::Reader reader(path);
    expect_input_error([&] { reader.frame(3); }, {"frame 3", "damaged"});
    EXPECT_EQ(reader.frame(2)->planes, decoded[2].planes) << "other groups are whole";
    EXPECT_EQ(reader.frame(6)->planes, decoded[6].planes);
}

TEST_F(NvsTest, IsAClipOfItsFrames) {
    const voctree::ClipIndex index = voctree::read_clip_index(path);
    EXPECT_EQ(index.fps, 12.5f);
    EXPECT_EQ(index.frames(), 7u);
    ASSERT_TRUE(index.plays_by_frame());
    EXPECT_EQ(index.plays_by_frame()->degree, tree.hh_degree);
    EXPECT_LE(index.plays_by_frame()->leaves, tree.leaf_count);
    const voctree::VOctree shown = voctree::read_segment(index.segments[5]);
    EXPECT_EQ(voctree::defect_of(shown), "");
    EXPECT_EQ(shown.frames, 1u);
    EXPECT_EQ(shown.leaf_count, decoded[5].leaves.size());
    const voctree::ClipHeader header = voctree::read_clip_header(path);
    EXPECT_EQ(header.frames, 7u);
    EXPECT_EQ(header.box_min, tree.box_min);
    expect_input_error([&] { voctree::read_clip(path); }, {"show.nvs", "is a stream"});
}

// A slice shows what the tree shows at that frame, up to rounding to 1 / kUnit.
TEST(SliceOfTree, ShowsTheFrame) {
    for (const uint32_t degree : {0u, 1u, 2u, 3u}) {
        const voctree::VOctree tree = random_tree({.seed = degree + 1, .leaves = 200, .hh_degree = degree});
        const std::vector<reference::LeafSlice> truth = reference::slice_tree(tree, 3);
        const QuantisedSlice slice = slice::quantised(voctree::slice_of(tree, 3));
        const voctree::VOctree still = voctree::tree_of(slice::values_of(slice, tree.box_min, tree.box_size), tree.fps);
        ASSERT_EQ(voctree::defect_of(still), "");
        const std::vector<reference::LeafSlice> shown = reference::slice_tree(still, 0);
        size_t compared = 0;
        const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(still);
        for (uint32_t i = 0; i < still.leaf_count; ++i) {
            const double side = std::ldexp(1.0, -static_cast<int>(positions[i].depth));
            const uint32_t leaf =
                voctree::find_leaf(tree, (glm::dvec3(positions[i].x, positions[i].y, positions[i].z) + 0.5) * side);
            ASSERT_NE(leaf, UINT32_MAX);
            const double edge = voctree::leaf_edge_m(tree, positions[i].depth);
            EXPECT_NEAR(std::exp(-shown[i].sigma * edge), std::exp(-truth[leaf].sigma * edge), 0.6 / stream::kUnit);
            for (size_t c = 0; c < 3; ++c) {
                const double mean = truth[leaf].k[c][0] * 0.28209479;
                if (std::abs(mean) > 3) continue;  // nearly black or white: its harmonics show little
                EXPECT_NEAR(reference::sigmoid(shown[i].k[c][0] * 0.28209479), reference::sigmoid(mean), 0.005);
                // The three planes round by up to half a unit each, which is more of a dark colour's coefficients.
                for (size_t k = 1; k < sh_count(degree); ++k)
                    EXPECT_NEAR(shown[i].k[c][k], truth[leaf].k[c][k], 0.11 + 0.02 * std::abs(truth[leaf].k[c][k]));
                ++compared;
            }
        }
        EXPECT_GT(compared, 100u);
        // Leaves that are left out are nearly clear.
        EXPECT_LE(still.leaf_count, tree.leaf_count);
    }
}

}  // namespace
}  // namespace neuvv::test::nvs_test
