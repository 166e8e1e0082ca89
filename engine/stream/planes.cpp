#include "stream/planes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "base/parallel.h"

namespace neuvv::stream {

namespace {

// How large the coefficients around are, 0 to 15: half of what it is around the larger cell, and twice the coefficient
// that divides that one. It is half in a cell without any.
using Activity = uint8_t;
Activity activity_below(Activity activity, int32_t number) {
    return static_cast<Activity>(std::min(activity / 2 + 2 * std::min(std::abs(number), 8), 15));
}
constexpr uint32_t activity_context(Activity activity) {
    constexpr uint8_t kContexts[16] = {0, 1, 2, 3, 3, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5};
    return kContexts[activity];
}

// The classes of depths: that of the finest pairs, the next, all others.
uint32_t depth_class(size_t depth, uint32_t finest) {
    return static_cast<uint32_t>(std::min<size_t>(finest - 1 - depth, kDepthClasses - 1));
}

// Of a number that has no symbol of its own: what it is beyond the largest symbol, as bits.
template <typename Coder>
uint32_t code_escaped(Coder& coder, uint32_t more) {
    const uint32_t bits = coder.take_bits(4, static_cast<uint32_t>(std::bit_width(more)) - 1);
    const uint32_t high_bits = bits > 8 ? bits - 8 : 0, low_bits = bits - high_bits;
    const uint32_t high = high_bits ? coder.take_bits(high_bits, more >> low_bits & ((1u << high_bits) - 1)) : 0;
    const uint32_t low = low_bits ? coder.take_bits(low_bits, more & ((1u << low_bits) - 1)) : 0;
    return 1u << bits | high << low_bits | low;
}

// Numbers from −7 to 7 are symbols; larger ones follow an escape.
template <typename Coder>
inline int16_t code_number(Coder& coder, uint32_t table, int32_t number) {
    constexpr uint32_t kEscape = kNumbers - 1;
    const auto folded = static_cast<uint32_t>(number > 0 ? 2 * number - 1 : -2 * number);
    uint32_t symbol = coder.take(table, std::min(folded, kEscape));
    if (symbol == kEscape) [[unlikely]]
        symbol = kEscape - 1 + code_escaped(coder, folded - kEscape + 1);
    return static_cast<int16_t>(symbol % 2 ? symbol / 2 + 1 : -(symbol / 2));
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

// One walk over a tree, depth by depth, for `Planes` of its planes.
template <typename Coder, size_t Planes>
class Walk {
  public:
    Walk(const Octree& tree, const Pairs& pairs, uint32_t finest, std::span<const PlaneOfTree> planes)
        : tree_(tree),
          next_pair_(pairs.data()),
          finest_(finest),
          planes_(planes),
          places_(std::make_unique_for_overwrite<Place[]>(tree.most_cells(finest))),
          below_(std::make_unique_for_overwrite<Place[]>(tree.most_cells(finest))) {
        Place& root = places_[0] = {};
        for (size_t p = 0; p < Planes; p++) {
            root.values[p] = planes[p].root;
            steps_[p] = planes[p].step;
            least_[p] = least_value(planes[p].number);
            most_[p] = most_value(planes[p].number);
            leaves_[p] = planes[p].leaves.data();
        }
    }

    // The streams may be empty.
    void run(std::span<Coder> coarse, std::span<Coder> fine) {
        for (size_t d = 0; d < finest_; d++) {
            const std::vector<Cell>& cells = tree_.cells[d];
            const std::span<Coder> coders = d + 1 < finest_ ? coarse : fine;
            set_tables(d);
            for (size_t i = 0; i < cells.size(); i++) {
                if (cells[i].children)
                    divide(cells[i], places_[i], coders, d + 1);
                else
                    set_leaf(cells[i].first, places_[i].values);
            }
            places_.swap(below_);
        }
    }

  private:
    // Four at a time, so that the processor computes them at once.
    static constexpr size_t kValues = Planes < 4 ? Planes : (Planes + 3) / 4 * 4;
    using Values = std::array<float, kValues>;
    using Activities = std::array<Activity, Planes>;
    struct alignas(16) Place {  // what is known of a cell
        Values values;
        Activities activities;
    };

    void set_tables(size_t depth) {
        for (size_t p = 0; p < Planes; p++)
            first_table_[p] = (kind_of(planes_[p].number) * kDepthClasses + depth_class(depth, finest_)) * kActivities;
    }

    // Gives the children of a cell, which are at depth `below`, their values.
    void divide(const Cell& cell, const Place& place, std::span<Coder> coders, size_t below) {
        const Splits& splits = kSplits[cell.children];
        uint32_t some = 0;  // planes with a number that is not 0
        if (!coders.empty() && splits.count > 0)
            for (size_t p = 0; p < Planes; p++) some |= code_any(coders[p], p, splits.count, place.activities[p]) << p;
        std::array<Place, 8> list;
        list[0] = place;
        if (splits.count > 0)
            for (Activity& activity : list[0].activities) activity /= 2;
        for (uint32_t k = 0; k < splits.count; k++) list[k + 1] = list[0];
        if (some) code_numbers(coders, some, splits, place.activities, list);
        next_pair_ += splits.count;
        number_ += splits.count;
        if (below == finest_) {
            const Cell* leaves = &tree_.cells[below][cell.first];
            for (uint32_t child = 0; child <= splits.count; child++)
                set_leaf(leaves[child].first, list[splits.order[child]].values);
        } else {
            for (uint32_t child = 0; child <= splits.count; child++)
                below_[cell.first + child] = list[splits.order[child]];
        }
    }

    // Whether any number of a cell's splits is not 0.
    uint32_t code_any(Coder& coder, size_t p, uint32_t count, Activity activity) {
        uint32_t any = 0;
        if constexpr (Coder::kWrites)
            for (uint32_t k = 0; k < count; k++) any |= planes_[p].numbers[number_ + k] != 0;
        return coder.take_either(kAnyTables + first_table_[p] + activity_context(activity), any);
    }

    // Codes the numbers of the planes of which some are not 0.
    void code_numbers(std::span<Coder> coders, uint32_t some, const Splits& splits, const Activities& activities,
                      std::array<Place, 8>& list) {
        std::array<Values, 7> numbers;
        for (uint32_t k = 0; k < splits.count; k++) numbers[k] = {};
        for (; some; some &= some - 1) {
            const auto p = static_cast<size_t>(std::countr_zero(some));
            const uint32_t table = kNumberTables + first_table_[p];
            list[0].activities[p] = activities[p];
            int32_t seen = 0;  // 0 where all numbers are
            for (uint32_t k = 0; k < splits.count; k++) {
                Activity& activity = list[splits.from[k]].activities[p];
                const int16_t given = Coder::kWrites ? planes_[p].numbers[number_ + k] : int16_t{0};
                const int16_t number = code_number(coders[p], table + activity_context(activity), given);
                seen |= number;
                activity = list[k + 1].activities[p] = activity_below(activity, number);
                numbers[k][p] = number;
            }
            if (seen == 0) throw std::runtime_error("has a cell of which all coefficients are 0");
        }
        for (uint32_t k = 0; k < splits.count; k++) {
            const Pair& pair = next_pair_[k];
            Values &a = list[splits.from[k]].values, &b = list[k + 1].values;
            for (size_t p = 0; p < kValues; p++) {
                const float apart = numbers[k][p] * steps_[p] * pair.inverse_scale;
                a[p] = a[p] - pair.share_b * apart;
                b[p] = a[p] + apart;
            }
        }
    }

    void set_leaf(uint32_t leaf, const Values& values) {
        std::array<int16_t, kValues> whole;
        for (size_t p = 0; p < kValues; p++) whole[p] = rounded(values[p], least_[p], most_[p]);
        for (size_t p = 0; p < Planes; p++) leaves_[p][leaf] = whole[p];
    }

    const Octree& tree_;
    const Pair* next_pair_;
    size_t number_ = 0;  // of the next pair
    uint32_t finest_;
    std::span<const PlaneOfTree> planes_;
    Values steps_{}, least_{}, most_{};
    std::array<int16_t*, Planes> leaves_;
    std::array<uint32_t, Planes> first_table_{};
    std::unique_ptr<Place[]> places_, below_;  // of the cells of a depth, and of the next
};

// Streams of planes do not depend on each other: where several are coded in one walk, the processor takes symbols of
// the one while it waits for a table of another. 9 in a walk took 25 ms where 3 took 29. Fewer leave work to other
// cores. Returns the first plane of each walk, and how many it has.
std::vector<std::pair<size_t, size_t>> planes_together(size_t planes) {
    std::vector<std::pair<size_t, size_t>> groups;
    for (size_t first = 0; first < planes; first += groups.back().second) {
        const size_t rest = planes - first;
        groups.emplace_back(first, rest >= 9 ? 9 : rest >= 3 ? 3 : 1);
    }
    return groups;
}

}  // namespace

int16_t rounded_value(float value, uint32_t plane) {
    return rounded(value, least_value(plane), most_value(plane));
}

template <typename Coder>
void code_planes(std::span<Coder> coarse, std::span<Coder> fine, const Octree& tree, const Pairs& pairs,
                 uint32_t finest, std::span<const PlaneOfTree> planes) {
    assert(tree.leaf_count > 0 && pairs.size() + 1 == tree.leaf_count);
    const std::vector<std::pair<size_t, size_t>> groups = planes_together(planes.size());
    parallel_for(groups.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) {
            const auto [first, count] = groups[i];
            const std::span<Coder> in_coarse = coarse.empty() ? coarse : coarse.subspan(first, count);
            const std::span<Coder> in_fine = fine.empty() ? fine : fine.subspan(first, count);
            const std::span<const PlaneOfTree> own = planes.subspan(first, count);
            if (count == 9)
                Walk<Coder, 9>(tree, pairs, finest, own).run(in_coarse, in_fine);
            else if (count == 3)
                Walk<Coder, 3>(tree, pairs, finest, own).run(in_coarse, in_fine);
            else
                Walk<Coder, 1>(tree, pairs, finest, own).run(in_coarse, in_fine);
        }
    });
}

template void code_planes<SymbolWriter>(std::span<SymbolWriter>, std::span<SymbolWriter>, const Octree&, const Pairs&,
                                        uint32_t, std::span<const PlaneOfTree>);
template void code_planes<SymbolReader>(std::span<SymbolReader>, std::span<SymbolReader>, const Octree&, const Pairs&,
                                        uint32_t, std::span<const PlaneOfTree>);

}  // namespace neuvv::stream
