// The coefficients of a plane as symbols. What a pair's coefficient is likely to be depends on those of the larger
// cells around it: where these were large, there is detail. `Coder` is a SymbolWriter or a SymbolReader; a reader
// replaces the numbers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <vector>

#include "stream/octree.h"
#include "stream/symbols.h"
#include "stream/transform.h"

namespace neuvv::stream {

// Kinds of planes have tables and a step of their own.
enum Kind : uint32_t { kOpacity, kLuma, kOrange, kGreen, kShLuma, kShChroma };
constexpr Kind kind_of(uint32_t plane) {
    if (plane <= 3) return static_cast<Kind>(plane);
    return (plane - 1) % 3 == 0 ? kShLuma : kShChroma;
}

// How large the coefficients around are, 0 to 15: half of what it is around the larger cell, and twice the coefficient
// that divides that one. It is half in a cell without any.
using Activity = uint8_t;
inline Activity activity_below(Activity activity, int32_t number) {
    return static_cast<Activity>(std::min(activity / 2 + 2 * std::min(std::abs(number), 8), 15));
}
constexpr uint32_t activity_context(Activity activity) {
    constexpr uint8_t kContexts[16] = {0, 1, 2, 3, 3, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5};
    return kContexts[activity];
}

// Numbers from −7 to 7 are symbols; larger ones follow an escape as bits.
template <typename Coder>
int16_t code_number(Coder& coder, uint32_t table, int32_t number) {
    const auto folded = static_cast<uint32_t>(number > 0 ? 2 * number - 1 : -2 * number);
    uint32_t symbol = coder.take(table, std::min(folded, kNumbers - 1));
    if (symbol == kNumbers - 1) {
        const uint32_t more = folded - symbol + 1;  // at least 1
        const uint32_t bits = coder.take_bits(4, static_cast<uint32_t>(std::bit_width(more)) - 1);
        const uint32_t high_bits = bits > 8 ? bits - 8 : 0, low_bits = bits - high_bits;
        const uint32_t high = high_bits ? coder.take_bits(high_bits, more >> low_bits & ((1u << high_bits) - 1)) : 0;
        const uint32_t low = low_bits ? coder.take_bits(low_bits, more & ((1u << low_bits) - 1)) : 0;
        symbol += (1u << bits | high << low_bits | low) - 1;
    }
    return static_cast<int16_t>(symbol % 2 ? symbol / 2 + 1 : -(symbol / 2));
}

// The numbers of one plane among those of several.
class PlaneNumbers {
  public:
    PlaneNumbers(Numbers& numbers, uint32_t plane) : next_(numbers.numbers.data() + plane), planes_(numbers.planes) {}
    int16_t& operator[](size_t pair) { return next_[pair * planes_]; }
    void skip(size_t pairs) { next_ += pairs * planes_; }

  private:
    int16_t* next_;
    size_t planes_;
};

// Codes the numbers of the pairs of one depth, and finds the activity of the cells of the next depth. Where no number
// of a cell differs from 0, that is one symbol.
template <typename Coder>
void code_depth(Coder& coder, const std::vector<Cell>& cells, Kind kind, uint32_t depth_class, PlaneNumbers& numbers,
                const std::vector<Activity>& activity, std::vector<Activity>& below) {
    const uint32_t first = (kind * kDepthClasses + depth_class) * kActivities;
    for (size_t c = 0; c < cells.size(); c++) {
        const Cell& cell = cells[c];
        if (!cell.children) continue;
        const uint32_t octants = octant_count(cell.children), pairs = octants - 1;
        if (pairs == 0) {
            below[cell.first] = activity[c];
            continue;
        }
        uint32_t any = 0;
        for (uint32_t i = 0; Coder::kWrites && i < pairs; i++) any |= numbers[i] != 0;
        any = coder.take(kAnyTables + first + activity_context(activity[c]), any);
        if (!any) {
            std::fill_n(&below[cell.first], octants, static_cast<Activity>(activity[c] / 2));
            numbers.skip(pairs);
            continue;
        }
        std::array<Activity, 8> of_octants;
        of_octants[0] = activity[c];
        int32_t seen = 0;  // 0 where all numbers are
        for_pairs(
            cell.children,
            [&](uint32_t i, uint32_t s) {
                int16_t& number = numbers[0];
                number = code_number(coder, kNumberTables + first + activity_context(of_octants[i]), number);
                seen |= number;
                of_octants[i] = of_octants[i + s] = activity_below(of_octants[i], number);
                numbers.skip(1);
            },
            [&](uint32_t i, uint32_t s) { of_octants[i + s] = of_octants[i]; });
        Activity* to = &below[cell.first];
        for (uint32_t octant = 0; octant < 8; octant++)
            if (cell.children >> octant & 1) *to++ = of_octants[octant];
        if (seen == 0) throw std::runtime_error("has a cell of which all coefficients are 0");
    }
}

// The classes of depths: that of the finest pairs, the next, all others.
constexpr uint32_t depth_class(size_t depth, uint32_t finest) {
    return static_cast<uint32_t>(std::min<size_t>(finest - 1 - depth, kDepthClasses - 1));
}

// Codes the numbers of a plane in two streams: `fine` has those of the finest pairs. A reader may have no `fine`; then
// these numbers stay. It must begin with numbers of 0.
template <typename Coder>
void code_plane(Coder& coarse, Coder* fine, const Octree& tree, uint32_t finest, Kind kind, PlaneNumbers numbers) {
    std::vector<Activity> activity = {0}, below;
    for (size_t depth = 0; depth + 1 < tree.cells.size(); depth++) {
        const bool is_finest = depth + 1 == finest;
        if (is_finest && !fine) break;
        below.resize(tree.cells[depth + 1].size());
        code_depth(is_finest ? *fine : coarse, tree.cells[depth], kind, depth_class(depth, finest), numbers, activity,
                   below);
        activity.swap(below);
    }
}

}  // namespace neuvv::stream
