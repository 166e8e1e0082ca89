// Tests layers of paint: edits against a plain table of times, and their files, including damaged ones.
#include "voctree/edit_layer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/error.h"
#include "base/platform.h"
#include "support/input_error.h"
#include "support/nvv_bytes.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/chunk_file.h"
#include "voctree/files/nvpaint.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kLeaves = 3, kFrames = 5, kSteps = 33;  // times an eighth of a frame apart

struct Look {
    glm::dvec3 premultiplied{0};
    double alpha = 0, sigma = -1;
};
using Table = std::array<std::array<Look, kSteps>, kLeaves>;

float frame_of(uint32_t step) {
    return static_cast<float>(step) / 8;
}

void paint_table(Table& table, const voctree::LeafEdit& edit) {
    for (uint32_t step = 0; step < kSteps; ++step) {
        if (frame_of(step) < edit.first || frame_of(step) > edit.last) continue;
        Look& look = table[edit.leaf][step];
        look.premultiplied =
            double{edit.alpha} * glm::dvec3(edit.colour) + (1.0 - double{edit.alpha}) * look.premultiplied;
        look.alpha = double{edit.alpha} + (1.0 - double{edit.alpha}) * look.alpha;
        if (edit.sigma >= 0) look.sigma = double{edit.sigma};
    }
}

void expect_table(const voctree::EditLayer& layer, const Table& table) {
    EXPECT_EQ(voctree::defect_of(layer), "");
    Table found;
    std::array<std::array<int, kSteps>, kLeaves> applying{};
    for (const voctree::LeafEdit& edit : layer.edits)
        for (uint32_t step = 0; step < kSteps; ++step) {
            if (frame_of(step) < edit.first || frame_of(step) > edit.last) continue;
            ++applying[edit.leaf][step];
            found[edit.leaf][step] = {glm::dvec3(edit.colour) * double{edit.alpha}, double{edit.alpha},
                                      double{edit.sigma}};
        }
    for (uint32_t leaf = 0; leaf < kLeaves; ++leaf)
        for (uint32_t step = 0; step < kSteps; ++step) {
            const Look &a = found[leaf][step], &b = table[leaf][step];
            EXPECT_LE(applying[leaf][step], 1);
            EXPECT_NEAR(a.alpha, b.alpha, 1e-6);
            EXPECT_LE(glm::distance(a.premultiplied, b.premultiplied), 1e-6);
            EXPECT_EQ(a.sigma, b.sigma) << "leaf " << leaf << " at " << frame_of(step);
        }
}

voctree::LeafEdit random_edit(Random& random) {
    voctree::LeafEdit edit;
    edit.leaf = random.below(kLeaves);
    const uint32_t a = random.below(kSteps), b = random.below(kSteps);
    edit.first = frame_of(std::min(a, b));
    edit.last = frame_of(std::max(a, b));
    const uint32_t kind = random.below(4);
    if (kind != 0) {
        edit.colour = glm::vec3(random.below(2), random.below(3) * 0.5, random.below(5) * 0.25);
        edit.alpha = kind == 1 ? 0.5f : 1.0f;
    }
    if (kind == 0 || random.below(3) == 0) edit.sigma = static_cast<float>(random.below(3));
    return edit;
}

TEST(PaintLayers, LaterEditsGoOverEarlierOnesAtEveryInstant) {
    for (uint32_t seed = 0; seed < 60; ++seed) {
        Random random(seed);
        voctree::EditLayer layer{{1, kLeaves, kFrames}, {}};
        Table table{};
        for (int stroke = 0; stroke < 6; ++stroke) {
            std::vector<voctree::LeafEdit> edits;
            for (uint32_t i = random.below(6); i > 0; --i) edits.push_back(random_edit(random));
            for (const voctree::LeafEdit& edit : edits) paint_table(table, edit);
            voctree::add_edits(layer, edits);
            if (random.below(3) == 0) {
                const std::array<uint32_t, 2> leaves = {2, random.below(2)};
                const float first = frame_of(random.below(kSteps)), last = frame_of(random.below(kSteps));
                voctree::remove_edits(layer, leaves, first, last);
                for (uint32_t leaf : leaves)
                    for (uint32_t step = 0; step < kSteps; ++step)
                        if (frame_of(step) >= first && frame_of(step) <= last) table[leaf][step] = {};
            }
            expect_table(layer, table);
        }
    }
}

TEST(PaintLayers, WhatIsTheSameStaysOneEdit) {
    voctree::EditLayer layer{{1, kLeaves, kFrames}, {}};
    const voctree::LeafEdit red{1, 1, 3, {1, 0, 0}, 1}, centre{1, 2, 2, {0, 1, 0}, 1};
    voctree::add_edits(layer, std::array{red});
    voctree::add_edits(layer, std::array{centre});
    ASSERT_EQ(layer.edits.size(), 3u) << "cut in two";
    EXPECT_EQ(layer.edits[0].last, std::nextafter(2.0f, 0.0f));
    voctree::add_edits(layer, std::array{red});
    EXPECT_EQ(layer.edits, std::vector{red}) << "and covered again";
}

struct PaintFile : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path path = folder.path / "layer.nvpaint";
    voctree::VOctree tree = random_tree({.seed = 5, .leaves = 200});
    voctree::EditLayer layer{voctree::painted_field(tree), {}};
    PaintFile() {
        Random random(1);
        std::vector<voctree::LeafEdit> edits;
        for (int i = 0; i < 300; ++i) {
            edits.push_back(random_edit(random));
            edits.back().leaf = random.below(tree.leaf_count);
        }
        voctree::add_edits(layer, edits);
    }
    // By hand, from the specification.
    std::vector<Chunk> chunks() const {
        Chunk header{"PTHD", {}}, leaves{"PTLF", {}};
        append(header.raw, layer.field.topology);
        append(header.raw, layer.field.leaf_count);
        append(header.raw, layer.field.frames);
        append(header.raw, static_cast<uint32_t>(layer.edits.size()));
        append(header.raw, uint32_t{0});
        for (int byte = 0; byte < 4; ++byte)
            for (size_t i = 0; i < layer.edits.size(); ++i) {
                const uint32_t step = layer.edits[i].leaf - (i ? layer.edits[i - 1].leaf : 0);
                leaves.raw.push_back(static_cast<uint8_t>(step >> 8 * byte));
            }
        std::vector<Chunk> all = {header, leaves};
        const auto column = [&](const char* name, auto number) {
            Chunk chunk{name, {}};
            for (const voctree::LeafEdit& edit : layer.edits) append(chunk.raw, number(edit));
            all.push_back(chunk);
        };
        column("PTF0", [](const voctree::LeafEdit& edit) { return edit.first; });
        column("PTF1", [](const voctree::LeafEdit& edit) { return edit.last; });
        column("PTCR", [](const voctree::LeafEdit& edit) { return edit.colour.r; });
        column("PTCG", [](const voctree::LeafEdit& edit) { return edit.colour.g; });
        column("PTCB", [](const voctree::LeafEdit& edit) { return edit.colour.b; });
        column("PTAL", [](const voctree::LeafEdit& edit) { return edit.alpha; });
        column("PTSG", [](const voctree::LeafEdit& edit) { return edit.sigma; });
        return all;
    }
    void put(const Bytes& bytes) const {
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    voctree::EditLayer read() const { return voctree::read_paint(path, layer.field); }
    void expect_complaint(const std::vector<Chunk>& damaged, const std::string& words) const {
        put(nvv_of(damaged));
        expect_input_error([&] { read(); }, {path.string(), words});
    }
};

TEST_F(PaintFile, ComesBackAndIsAsSpecified) {
    voctree::write_paint(path, layer);
    EXPECT_EQ(read().edits, layer.edits);
    voctree::ChunkReader file(path);
    voctree::ChunkHeader header;
    for (const Chunk& chunk : chunks()) {
        ASSERT_TRUE(file.next(header));
        EXPECT_EQ(header.name, chunk.name);
        EXPECT_EQ(file.take(header.raw_bytes), chunk.raw);
    }
    EXPECT_FALSE(file.next(header));
    put(nvv_of(chunks()));
    EXPECT_EQ(read().edits, layer.edits);
    layer.edits.clear();
    voctree::write_paint(path, layer);
    EXPECT_TRUE(read().edits.empty());
}

TEST_F(PaintFile, OfAnotherFieldIsRefused) {
    voctree::write_paint(path, layer);
    const voctree::VOctree other = random_tree({.seed = 6, .leaves = 200});
    expect_input_error([&] { voctree::read_paint(path, voctree::painted_field(other)); },
                       {"PTHD", "another", "painted on"});
    voctree::PaintedField longer = layer.field;
    ++longer.frames;
    expect_input_error([&] { voctree::read_paint(path, longer); }, {"5 frames, not 6"});
    voctree::VOctree same = tree;
    same.weights[0] += 1;
    EXPECT_EQ(voctree::painted_field(same), voctree::painted_field(tree)) << "the same leaves, however they look";
    voctree::write_nvv(path, tree);
    expect_input_error([&] { read(); }, {"not a layer of paint"});
    expect_input_error([&] { voctree::read_paint(folder.path / "none.nvpaint", layer.field); },
                       {"no such file", "check the path"});
}

TEST_F(PaintFile, EveryDamagedByteAndEveryMissingEndIsRefused) {
    voctree::write_paint(path, layer);
    const std::vector<uint8_t> sound = read_file(path);
    for (size_t i = 0; i < sound.size(); i += 3) {
        Bytes damaged = sound;
        damaged[i] ^= static_cast<uint8_t>(1u << i % 8);
        put(damaged);
        EXPECT_THROW(read(), InputError) << "byte " << i;
        put(Bytes(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(i)));
        EXPECT_THROW(read(), InputError) << "cut at " << i;
    }
}

TEST_F(PaintFile, NumbersThatAreNoneAreRefused) {
    const auto with = [&](size_t chunk, size_t at, auto value) {
        std::vector<Chunk> damaged = chunks();
        std::memcpy(&damaged[chunk].raw[at], &value, sizeof value);
        return damaged;
    };
    expect_complaint(with(0, 16, 0xffffffffu), "edit_count");
    expect_complaint(with(0, 16, 7u), "bytes");
    expect_complaint(with(0, 20, 1u), "does not know");
    expect_complaint(with(1, 3 * layer.edits.size(), uint8_t{9}), "does not exist");
    expect_complaint(with(2, 0, NAN), "frames");
    expect_complaint(with(2, 0, -1.0f), "frames");
    expect_complaint(with(3, 40, 5.0f), "frames");
    expect_complaint(with(4, 8, 1.5f), "colour");
    expect_complaint(with(6, 8, static_cast<float>(INFINITY)), "colour");
    expect_complaint(with(7, 0, NAN), "alpha");
    expect_complaint(with(8, 0, -2.0f), "density");
    expect_complaint(with(8, 0, 1e6f), "density");
    std::vector<Chunk> swapped = chunks();
    std::swap(swapped[2], swapped[3]);
    expect_complaint(swapped, "is where chunk PTF0 must be");
    std::vector<Chunk> less = chunks();
    less.pop_back();
    expect_complaint(less, "before chunk PTSG");
    std::vector<Chunk> more = chunks();
    more.push_back({"PTXX", {1}});
    expect_complaint(more, "unknown");
    more.back().name = "ptXX";
    put(nvv_of(more));
    EXPECT_EQ(read().edits, layer.edits) << "ancillary";
    std::swap(layer.edits[0], layer.edits[20]);
    expect_complaint(chunks(), "out of order");
    EXPECT_THROW(voctree::write_paint(path, layer), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test
