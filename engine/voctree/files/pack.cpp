#include "voctree/files/pack.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/threads/parallel.h"
#include "voctree/files/half.h"

namespace neuvv::voctree {

namespace {

// The coding of a column, which the file stores as a byte:
//   0..24       the numbers are multiples of 2^−coding, each stored as the difference of its multiple to the one before
//   128..143    the numbers are halves, stored as their bits without the lowest coding − 128, which are 0
constexpr uint32_t kFinestStep = 24;  // the smallest positive half is 2^−24
constexpr uint32_t kHalfCoding = 128, kMaxShift = 15;

// A column, or a block's part of it, while it is encoded or decoded.
struct Column {
    uint32_t coding = 0;
    float scale = 1;     // 2^coding
    size_t count = 0;    // of its numbers
    size_t at = 0;       // index of its next number among the numbers of all columns
    int16_t before = 0;  // the multiple of the number before the next

    void set_coding(uint32_t value) {
        coding = value;
        if (coding < kHalfCoding) scale = std::ldexp(1.0f, static_cast<int>(coding));
    }
    // Of 2^−coding, as a half; 0 where halves themselves are stored.
    int16_t multiple_of(float weight) const {
        if (coding >= kHalfCoding) return 0;
        return static_cast<int16_t>(float_from_half(half_from_float(weight)) * scale);
    }
};

bool is_present(const std::vector<uint8_t>& presence, size_t leaves, size_t leaf, uint32_t column) {
    return presence[column / 8 * leaves + leaf] >> column % 8 & 1;
}

constexpr uint32_t kBlockLeaves = 1u << 14;  // leaves of a block; blocks are encoded and decoded in parallel

struct LeafRange {
    uint32_t begin, end;
};

// Calls visit(leaf, column in range) for each number, leaf by leaf, because a leaf's weights are adjacent in memory.
template <typename Visit>
void for_each_number(const VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence, LeafRange leaves,
                     Visit visit) {
    for (uint32_t leaf = leaves.begin; leaf < leaves.end; ++leaf)
        for (uint32_t column = 0; column < range.count; ++column)
            if (!range.sparse || is_present(presence, tree.leaf_count, leaf, column)) visit(leaf, column);
}

LeafRange leaves_of_block(const VOctree& tree, size_t block) {
    const auto begin = static_cast<uint32_t>(block * kBlockLeaves);
    return {begin, std::min(begin + kBlockLeaves, tree.leaf_count)};
}

size_t count_of_blocks(const VOctree& tree) {
    return (size_t{tree.leaf_count} + kBlockLeaves - 1) / kBlockLeaves;
}

// `blocks` has for each block of leaves the part of each column that belongs to it, of which only the count is known.
// Sets the codings, and where each part begins.
void lay_out(std::vector<std::vector<Column>>& blocks, const uint8_t* codings) {
    size_t at = 0;
    for (size_t column = 0; !blocks.empty() && column < blocks[0].size(); ++column)
        for (std::vector<Column>& block : blocks) {
            block[column].at = at;
            block[column].set_coding(codings[column]);
            at += block[column].count;
        }
}

// What decides the coding of a column.
struct Digits {
    uint16_t bits = 0;     // the halves' bits, or-ed
    uint32_t finest = 0;   // all numbers are multiples of 2^−finest
    uint16_t largest = 0;  // the bits of the largest magnitude

    void add(uint16_t half) {
        const uint16_t magnitude = half & 0x7fff;
        bits |= half;
        if (magnitude == 0) return;
        largest = std::max(largest, magnitude);
        const uint32_t exponent = magnitude >> 10, fraction = magnitude & 0x3ff;
        const uint32_t digits = exponent > 0 ? fraction | 0x400 : fraction;
        const int lowest = std::max(static_cast<int>(exponent), 1) - 25 + std::countr_zero(digits);
        finest = std::max(finest, static_cast<uint32_t>(std::max(-lowest, 0)));
    }
    void add(const Digits& other) {
        bits |= other.bits;
        finest = std::max(finest, other.finest);
        largest = std::max(largest, other.largest);
    }
    uint32_t coding() const {
        const bool fits = std::ldexp(float_from_half(largest), static_cast<int>(finest)) <= INT16_MAX;
        return fits ? finest : kHalfCoding + static_cast<uint32_t>(std::countr_zero(bits));
    }
};

// Maps a signed step to an unsigned number: 0, −1, 1, −2, … to 0, 1, 2, 3, …
uint16_t folded(int16_t step) {
    return static_cast<uint16_t>((step << 1) ^ (step >> 15));
}

int16_t unfolded(uint16_t number) {
    return static_cast<int16_t>((number >> 1) ^ -(number & 1));
}

uint16_t encode(Column& column, float weight) {
    if (column.coding >= kHalfCoding)
        return static_cast<uint16_t>(half_from_float(weight) >> (column.coding - kHalfCoding));
    const int16_t multiple = column.multiple_of(weight);
    const auto step = static_cast<int16_t>(multiple - column.before);
    column.before = multiple;
    return folded(step);
}

float decode(Column& column, uint16_t number) {
    if (column.coding >= kHalfCoding)
        return float_from_half(static_cast<uint16_t>(number << (column.coding - kHalfCoding)));
    column.before = static_cast<int16_t>(column.before + unfolded(number));
    return float_from_half(half_from_float(static_cast<float>(column.before) / column.scale));
}

}  // namespace

std::vector<uint8_t> pack_children(const std::vector<uint32_t>& children) {
    std::vector<uint8_t> bytes(4 * children.size());
    uint32_t before = 0;
    for (size_t i = 0; i < children.size(); ++i) {
        const uint32_t step = children[i] - before;
        before = children[i];
        for (size_t plane = 0; plane < 4; ++plane)
            bytes[plane * children.size() + i] = static_cast<uint8_t>(step >> (8 * plane));
    }
    return bytes;
}

std::vector<uint32_t> unpack_children(const std::vector<uint8_t>& bytes) {
    std::vector<uint32_t> children(bytes.size() / 4);
    uint32_t before = 0;
    for (size_t i = 0; i < children.size(); ++i) {
        for (size_t plane = 0; plane < 4; ++plane)
            before += uint32_t{bytes[plane * children.size() + i]} << (8 * plane);
        children[i] = before;
    }
    return children;
}

std::vector<uint8_t> pack_presence(const VOctree& tree) {
    std::vector<uint8_t> presence(size_t{(tree.bases + 7) / 8} * tree.leaf_count);
    parallel_for(tree.leaf_count, kBlockLeaves, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf) {
            const float* weights = tree.leaf(static_cast<uint32_t>(leaf));
            for (uint32_t c = 0; c < tree.bases; ++c)
                if (((half_from_float(weights[c]) | half_from_float(weights[tree.bases + c])) & 0x7fff) != 0)
                    presence[c / 8 * size_t{tree.leaf_count} + leaf] |= static_cast<uint8_t>(1u << c % 8);
        }
    });
    return presence;
}

bool presence_fits(const VOctree& tree, const std::vector<uint8_t>& presence) {
    if (tree.bases % 8 == 0) return true;
    const size_t last = tree.bases / 8 * size_t{tree.leaf_count};
    return std::all_of(presence.begin() + static_cast<ptrdiff_t>(last), presence.end(),
                       [&](uint8_t bits) { return bits >> tree.bases % 8 == 0; });
}

std::vector<uint8_t> pack_weights(const VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence) {
    std::vector<std::vector<Column>> blocks(count_of_blocks(tree), std::vector<Column>(range.count));
    std::vector<std::vector<Digits>> digits(blocks.size(), std::vector<Digits>(range.count));
    std::vector<std::vector<float>> last(blocks.size(), std::vector<float>(range.count));  // numbers
    parallel_for(blocks.size(), 1, [&](size_t block, size_t) {
        for_each_number(tree, range, presence, leaves_of_block(tree, block), [&](uint32_t leaf, uint32_t column) {
            const float weight = tree.leaf(leaf)[range.first + column];
            ++blocks[block][column].count;
            digits[block][column].add(half_from_float(weight));
            last[block][column] = weight;
        });
    });
    size_t numbers = 0;
    std::vector<uint8_t> codings(range.count);
    for (uint32_t column = 0; column < range.count; ++column) {
        Digits all;
        for (size_t block = 0; block < blocks.size(); ++block) {
            all.add(digits[block][column]);
            numbers += blocks[block][column].count;
        }
        codings[column] = static_cast<uint8_t>(all.coding());
    }
    lay_out(blocks, codings.data());
    for (uint32_t column = 0; column < range.count; ++column)
        for (size_t block = 1; block < blocks.size(); ++block) {
            const Column& left = blocks[block - 1][column];
            blocks[block][column].before = left.count > 0 ? left.multiple_of(last[block - 1][column]) : left.before;
        }
    std::vector<uint8_t> bytes(range.count + 2 * numbers);
    std::copy(codings.begin(), codings.end(), bytes.begin());
    uint8_t* low = bytes.data() + range.count;
    parallel_for(blocks.size(), 1, [&](size_t block, size_t) {
        std::vector<Column>& columns = blocks[block];
        for_each_number(tree, range, presence, leaves_of_block(tree, block), [&](uint32_t leaf, uint32_t column) {
            const uint16_t number = encode(columns[column], tree.leaf(leaf)[range.first + column]);
            const size_t at = columns[column].at++;
            low[at] = static_cast<uint8_t>(number);
            low[numbers + at] = static_cast<uint8_t>(number >> 8);
        });
    });
    return bytes;
}

uint64_t packed_weight_bytes(const VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence) {
    uint64_t numbers = 0;
    if (!range.sparse) numbers = uint64_t{tree.leaf_count} * range.count;
    if (range.sparse)
        for (const uint8_t bits : presence) numbers += static_cast<uint64_t>(std::popcount(bits));
    return range.count + 2 * numbers;
}

bool unpack_weights(VOctree& tree, WeightRange range, const std::vector<uint8_t>& presence,
                    const std::vector<uint8_t>& bytes) {
    for (uint32_t column = 0; column < range.count; ++column) {
        const uint32_t coding = bytes[column];
        if (coding > kFinestStep && (coding < kHalfCoding || coding > kHalfCoding + kMaxShift)) return false;
    }
    const size_t numbers = (bytes.size() - range.count) / 2;
    const uint8_t* low = bytes.data() + range.count;
    const auto number_at = [&](size_t at) { return static_cast<uint16_t>(low[at] | low[numbers + at] << 8); };
    std::vector<std::vector<Column>> blocks(count_of_blocks(tree), std::vector<Column>(range.count));
    parallel_for(blocks.size(), 1, [&](size_t block, size_t) {
        for_each_number(tree, range, presence, leaves_of_block(tree, block),
                        [&](uint32_t, uint32_t column) { blocks[block][column].count++; });
    });
    lay_out(blocks, bytes.data());
    // The multiple before a block's first number is the sum of all steps before the block.
    parallel_for(range.count, 1, [&](size_t first, size_t) {
        int16_t sum = 0;
        for (std::vector<Column>& block : blocks) {
            Column& column = block[first];
            column.before = sum;
            if (column.coding >= kHalfCoding) continue;
            for (size_t i = 0; i < column.count; ++i)
                sum = static_cast<int16_t>(sum + unfolded(number_at(column.at + i)));
        }
    });
    parallel_for(blocks.size(), 1, [&](size_t block, size_t) {
        for_each_number(tree, range, presence, leaves_of_block(tree, block), [&](uint32_t leaf, uint32_t column) {
            Column& here = blocks[block][column];
            tree.leaf(leaf)[range.first + column] = decode(here, number_at(here.at++));
        });
    });
    return true;
}

}  // namespace neuvv::voctree
