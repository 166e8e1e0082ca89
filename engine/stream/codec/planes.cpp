#include "stream/codec/planes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "stream/codec/activity.h"

namespace neuvv::stream {

namespace {

// Of a number that has no symbol of its own: what it is beyond the largest symbol, as bits.
template <typename Coder>
uint32_t code_escaped(Coder& coder, uint32_t more) {
    const uint32_t bits = coder.take_bits(4, static_cast<uint32_t>(std::bit_width(more)) - 1);
    const uint32_t high_bits = bits > 8 ? bits - 8 : 0, low_bits = bits - high_bits;
    const uint32_t high = high_bits ? coder.take_bits(high_bits, more >> low_bits & ((1u << high_bits) - 1)) : 0;
    const uint32_t low = low_bits ? coder.take_bits(low_bits, more & ((1u << low_bits) - 1)) : 0;
    return 1u << bits | high << low_bits | low;
}

// Numbers from −7 to 7 are symbols; larger ones follow an escape. `activity` becomes what it is below.
template <typename Coder>
inline int16_t code_number(Coder& coder, uint32_t first_table, int32_t number, Activity& activity) {
    const uint32_t given = folded(number);
    uint32_t symbol = coder.take(first_table + activity_context(activity), std::min(given, kEscape));
    activity = activity_below(activity, symbol);
    if (symbol == kEscape) [[unlikely]]
        symbol = kEscape - 1 + code_escaped(coder, given - kEscape + 1);
    const auto size = static_cast<int32_t>((symbol + 1) / 2), sign = -static_cast<int32_t>(~symbol & 1);
    return static_cast<int16_t>((size ^ sign) - sign);
}

float least_value(uint32_t plane) {
    return plane == kOpacityPlane ? 0 : -4 * kUnit;
}
float most_value(uint32_t plane) {
    return plane == kOpacityPlane ? kUnit : 4 * kUnit;
}

int16_t rounded(float value, float least, float most) {
    const float raised = std::clamp(value, least, most) + 0.5f;
    const auto cut = static_cast<int32_t>(raised);  // std::floor is a call where the processor may be an old one
    return static_cast<int16_t>(static_cast<float>(cut) > raised ? cut - 1 : cut);
}

// Four numbers that a processor computes at once, and the bits of four.
using Four = float __attribute__((vector_size(16)));
using FourBits = int32_t __attribute__((vector_size(16)));

Four four_at(const float* numbers) {
    Four four;
    std::memcpy(&four, numbers, sizeof four);
    return four;
}
Four four_at(const int16_t* numbers) {
    return Four{static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2]),
                static_cast<float>(numbers[3])};
}
Four where(const FourBits& bits, const Four& four) {
    return __builtin_bit_cast(Four, bits & __builtin_bit_cast(FourBits, four));
}

using Numbers = std::array<int16_t, kPairs>;  // of the pairs of a cell; 0 where there is no pair
using Values = std::array<float, 8>;          // of the octants of a cell

// Divides a cell: v_a = v − β e, v_b = v_a + e, for all octants at once. Where there is no pair, e is 0.
Values values_of(float value, const Numbers& numbers, float step, const CellPairs& pairs) {
    const float* scale = pairs.inverse_scale.data();
    const Four apart = four_at(numbers.data()) * step * four_at(scale);  // of pairs 0 to 3
    const Four apart_x = four_at(numbers.data() + 4) * step * four_at(scale + 4);
    const Four part = four_at(pairs.share_b.data()) * apart, part_x = four_at(pairs.share_b.data() + 4) * apart_x;
    Four v = value - __builtin_shufflevector(part, part, 1, 1, 1, 1);
    v += where(FourBits{0, 0, -1, -1}, __builtin_shufflevector(apart, apart, 1, 1, 1, 1));
    v -= __builtin_shufflevector(part, part, 2, 2, 3, 3);
    v += where(FourBits{0, -1, 0, -1}, __builtin_shufflevector(apart, apart, 2, 2, 3, 3));
    const Four a = v - part_x, b = a + apart_x;
    const std::array<Four, 2> both = {__builtin_shufflevector(a, b, 0, 4, 1, 5),
                                      __builtin_shufflevector(a, b, 2, 6, 3, 7)};
    return __builtin_bit_cast(Values, both);
}

// Writes something for each child of a cell, from the places that `from` says, or the same for all: eight of them,
// which is faster than to count. Those behind the cell's own children are written later.
template <typename Number>
void write_children(const std::array<Number, 8>& numbers, const std::array<uint8_t, 8>& from, Number* to) {
    for (size_t child = 0; child < 8; ++child) to[child] = numbers[from[child]];
}
template <typename Number>
void fill_children(Number number, Number* to) {
    for (size_t child = 0; child < 8; ++child) to[child] = number;
}

// One walk over a tree, depth by depth, for some of its planes.
template <typename Coder>
class Walk {
  public:
    Walk(const Octree& tree, const Pairs& pairs, uint32_t finest, std::span<const PlaneOfTree> planes)
        : tree_(tree), pairs_(pairs), finest_(finest) {
        size_t cells = 8;  // write_children may write that many more
        for (const std::vector<Cell>& of_depth : tree.cells) cells += of_depth.size();
        for (const PlaneOfTree& plane : planes) {
            Plane& own = planes_.emplace_back(plane);
            own.values = std::unique_ptr<float[]>(new float[cells]);
            own.activities = std::unique_ptr<Activity[]>(new Activity[cells]);
            own.values[0] = plane.root;
            own.activities[0] = 0;
        }
    }

    // The streams may be empty.
    void run(std::span<Coder> coarse, std::span<Coder> fine) {
        std::vector<std::pair<uint32_t, uint32_t>> large;  // leaves above the finest depth, and their cells
        large.reserve(tree_.large_count());
        uint32_t number = 0;  // of the cell
        for (size_t d = 0; d < tree_.cells.size(); ++d) {
            const std::vector<Cell>& cells = tree_.cells[d];
            const bool is_last = d + 1 == tree_.cells.size();
            coders_ = d + 1 == finest_ ? fine : coarse;
            below_ = number + cells.size();
            for (Plane& plane : planes_) plane.first_table = first_plane_table(kind_of(plane.given.number), d, finest_);
            for (const Cell& cell : cells) {
                if (!cell.children)
                    large.emplace_back(cell.first, number);
                else if (is_last)
                    divide<true>(cell, d, number);
                else
                    divide<false>(cell, d, number);
                ++number;
            }
        }
        // Now there is nothing more that is written over them.
        for (const Plane& plane : planes_)
            for (const auto& [leaf, cell] : large)
                plane.given.leaves[leaf] = rounded(plane.values[cell], plane.least, plane.most);
    }

  private:
    struct Plane {
        explicit Plane(const PlaneOfTree& plane)
            : given(plane), least(least_value(plane.number)), most(most_value(plane.number)) {}
        PlaneOfTree given;
        float least, most;
        uint32_t first_table = 0;
        // Of all cells above the finest depth.
        std::unique_ptr<float[]> values;
        std::unique_ptr<Activity[]> activities;
    };

    // Gives the children of a cell their values. `number` is the cell's among all.
    template <bool kLast>
    void divide(const Cell& cell, size_t depth, size_t number) {
        const Splits& splits = kSplits[cell.children];
        uint64_t some = 0;  // planes with a number that is not 0
        if (!coders_.empty() && splits.count > 0)
            for (size_t p = 0; p < planes_.size(); ++p)
                some |= uint64_t{code_any(coders_[p], planes_[p], splits, planes_[p].activities[number])} << p;
        if (some) cell_pairs_ = pairs_.of(depth, cell);
        if constexpr (kLast) {
            const uint32_t first = cell.first;
            if (first + 8 <= tree_.leaf_count) {
                for (size_t p = 0; p < planes_.size(); ++p)
                    set_leaves(p, number, splits, some >> p & 1, planes_[p].given.leaves.data() + first);
            } else {  // there may be no place for eight
                for (size_t p = 0; p < planes_.size(); ++p) {
                    std::array<int16_t, 8> leaves;
                    set_leaves(p, number, splits, some >> p & 1, leaves.data());
                    std::copy_n(leaves.data(), splits.count + 1, planes_[p].given.leaves.data() + first);
                }
            }
        } else {
            for (size_t p = 0; p < planes_.size(); ++p)
                set_cells(p, number, splits, some >> p & 1, below_ + cell.first);
        }
        ++divided_;
    }

    void set_leaves(size_t p, size_t number, const Splits& splits, bool has_numbers, int16_t* leaves) {
        const Plane& plane = planes_[p];
        const float value = plane.values[number];
        if (!has_numbers) return fill_children(rounded(value, plane.least, plane.most), leaves);
        std::array<Activity, 8> activities;
        activities[0] = plane.activities[number];
        const Values values = coded_values(p, value, splits, activities);
        std::array<int16_t, 8> whole;
        for (size_t k = 0; k < 8; ++k) whole[k] = rounded(values[k], plane.least, plane.most);
        write_children(whole, splits.octant, leaves);
    }

    void set_cells(size_t p, size_t number, const Splits& splits, bool has_numbers, size_t first) {
        const Plane& plane = planes_[p];
        const float value = plane.values[number];
        const Activity activity = plane.activities[number];
        if (!has_numbers) {
            fill_children(value, &plane.values[first]);
            fill_children(static_cast<Activity>(splits.count > 0 ? activity / 2 : activity), &plane.activities[first]);
            return;
        }
        std::array<Activity, 8> activities;
        activities[0] = activity;
        write_children(coded_values(p, value, splits, activities), splits.octant, &plane.values[first]);
        write_children(activities, splits.of_child, &plane.activities[first]);
    }

    // Whether any number of a cell's pairs is not 0.
    uint32_t code_any(Coder& coder, const Plane& plane, const Splits& splits, Activity activity) {
        uint32_t any = 0;
        if constexpr (Coder::kWrites)
            for (uint32_t k = 0; k < splits.count; ++k) any |= plane.given.numbers[divided_][splits.pair[k]] != 0;
        any = coder.take_either(kAnyTables + plane.first_table + activity_context(activity), any);
        return coder.is_over() ? 0 : any;
    }

    // Codes numbers of which some are not 0, and returns the values that they make. `activities` begins with that of
    // the cell and becomes those below.
    Values coded_values(size_t p, float value, const Splits& splits, std::array<Activity, 8>& activities) {
        const Plane& plane = planes_[p];
        Numbers numbers{};
        if constexpr (Coder::kWrites) {
            numbers = plane.given.numbers[divided_];
            code_numbers(coders_[p], plane.first_table, splits, numbers, activities);
        } else {
            Coder coder = coders_[p];  // as one of its own, it is kept in registers
            code_numbers(coder, plane.first_table, splits, numbers, activities);
            coders_[p] = coder;
        }
        if (coders_[p].is_over()) numbers = {};
        return values_of(value, numbers, plane.given.step, cell_pairs_);
    }

    static void code_numbers(Coder& coder, uint32_t first_table, const Splits& splits, Numbers& numbers,
                             std::array<Activity, 8>& activities) {
        int32_t seen = 0;  // 0 where all numbers are
        for (uint32_t k = 0; k < splits.count; ++k) {
            Activity activity = activities[splits.above[k]];
            int16_t& number = numbers[splits.pair[k]];
            number = code_number(coder, kNumberTables + first_table, number, activity);
            seen |= number;
            activities[k + 1] = activity;
        }
        if (seen == 0 && !coder.is_over()) throw std::runtime_error("has a cell of which all coefficients are 0");
    }

    const Octree& tree_;
    const Pairs& pairs_;
    CellPairs cell_pairs_;  // of the cell that is divided, where it has numbers that are not 0
    size_t divided_ = 0;    // cells
    size_t below_ = 0;      // the number of the first cell of the next depth
    uint32_t finest_;
    std::span<Coder> coders_;
    std::vector<Plane> planes_;
};

}  // namespace

int16_t rounded_value(float value, uint32_t plane) {
    return rounded(value, least_value(plane), most_value(plane));
}

template <typename Coder>
void code_planes(std::span<Coder> coarse, std::span<Coder> fine, const Octree& tree, const Pairs& pairs,
                 uint32_t finest, std::span<const PlaneOfTree> planes) {
    assert(tree.leaf_count > 0);
    Walk<Coder>(tree, pairs, finest, planes).run(coarse, fine);
}

template void code_planes<SymbolWriter>(std::span<SymbolWriter>, std::span<SymbolWriter>, const Octree&, const Pairs&,
                                        uint32_t, std::span<const PlaneOfTree>);
template void code_planes<SymbolReader>(std::span<SymbolReader>, std::span<SymbolReader>, const Octree&, const Pairs&,
                                        uint32_t, std::span<const PlaneOfTree>);

}  // namespace neuvv::stream
