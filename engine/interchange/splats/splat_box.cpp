#include "interchange/splats/splat_box.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace neuvv::interchange {

namespace {

constexpr double kDeviations = 2;      // of a splat that count as inside a box
constexpr size_t kFloatersOf = 50;     // splats that one may float among, at each end of an axis
constexpr size_t kFewest = 10;         // splats among which one may float
constexpr double kMarginOfMiddle = 2;  // sizes of the middle that splats may lie around it
constexpr size_t kOutsideDense = 10;   // of so many splats, one is outside the dense box at each end of an axis
constexpr size_t kFewestOfDense = 4;
constexpr double kDenseIsSmaller = 4;

SplatBox extent_of(const Splat& splat) {
    const glm::mat3 axes = glm::transpose(glm::mat3_cast(splat.rotation));  // its columns are rows of the rotation
    glm::dvec3 reach;
    for (int i = 0; i < 3; ++i) reach[i] = kDeviations * double{glm::length(axes[i] * splat.deviation)};
    return {glm::dvec3(splat.centre) - reach, glm::dvec3(splat.centre) + reach};
}

// A splat that can be seen.
struct Seen {
    const Splat* splat;
    SplatBox extent;
};

std::vector<Seen> seen_of(const Splats& splats) {
    std::vector<Seen> seen;
    for (const Splat& splat : splats.splats)
        if (splat.opacity >= kFaintestOpacity) seen.push_back({&splat, extent_of(splat)});
    return seen;
}

bool lies_in(const SplatBox& inner, const SplatBox& outer) {
    return glm::all(glm::greaterThanEqual(inner.low, outer.low)) &&
           glm::all(glm::lessThanEqual(inner.high, outer.high));
}

void include(SplatBox& box, const SplatBox& other, bool is_first) {
    box.low = is_first ? other.low : glm::min(box.low, other.low);
    box.high = is_first ? other.high : glm::max(box.high, other.high);
}

// Without the `cut` outermost splats at each end of each axis.
SplatBox middle_of(const std::vector<Seen>& seen, size_t cut) {
    SplatBox box;
    std::vector<double> ends(seen.size());
    const auto nth = [&](size_t n) {
        std::nth_element(ends.begin(), ends.begin() + static_cast<ptrdiff_t>(n), ends.end());
        return ends[n];
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (size_t i = 0; i < seen.size(); ++i) ends[i] = seen[i].extent.low[axis];
        box.low[axis] = nth(cut);
        for (size_t i = 0; i < seen.size(); ++i) ends[i] = seen[i].extent.high[axis];
        box.high[axis] = nth(seen.size() - 1 - cut);
    }
    return box;
}

}  // namespace

double SplatBox::longest_m() const {
    const glm::dvec3 size = high - low;
    return std::max({size.x, size.y, size.z});
}

SplatBox box_of(const Splats& splats) {
    SplatBox box;
    bool is_first = true;
    for (const Seen& seen : seen_of(splats)) {
        include(box, seen.extent, is_first);
        is_first = false;
    }
    return box;
}

MainBox main_box_of(const Splats& splats) {
    MainBox main;
    const std::vector<Seen> seen = seen_of(splats);
    if (seen.empty()) return main;
    const size_t cut = std::max<size_t>(seen.size() / kFloatersOf, seen.size() >= kFewest ? 1 : 0);
    const SplatBox middle = middle_of(seen, cut);
    const glm::dvec3 margin(kMarginOfMiddle * middle.longest_m());
    const SplatBox most{middle.low - margin, middle.high + margin};
    const glm::dvec3 centre = 0.5 * (middle.low + middle.high);
    double farthest = -1;
    bool is_first = true;
    for (const Seen& each : seen) {
        if (lies_in(each.extent, most)) {
            include(main.box, each.extent, is_first);
            is_first = false;
            continue;
        }
        ++main.beyond;
        const glm::dvec3 end = glm::max(glm::abs(each.extent.low - centre), glm::abs(each.extent.high - centre));
        if (const double distance = std::max({end.x, end.y, end.z}); distance > farthest) {
            farthest = distance;
            main.farthest = each.splat;
        }
    }
    if (seen.size() >= kFewestOfDense) {
        const SplatBox dense = middle_of(seen, std::max<size_t>(seen.size() / kOutsideDense, 1));
        if (kDenseIsSmaller * dense.longest_m() < main.box.longest_m()) main.dense = dense;
    }
    return main;
}

void crop(Splats& splats, const SplatBox& box) {
    std::erase_if(splats.splats, [&](const Splat& splat) {
        const SplatBox extent = extent_of(splat);
        return glm::any(glm::lessThan(extent.high, box.low)) || glm::any(glm::greaterThan(extent.low, box.high));
    });
}

std::string place_of(const Splat& splat) {
    return fmt::format("splat {} at ({:.6g}, {:.6g}, {:.6g})", splat.row, splat.centre.x, splat.centre.y,
                       splat.centre.z);
}

std::string text_of(const SplatBox& box) {
    return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", box.low.x, box.low.y, box.low.z, box.high.x,
                       box.high.y, box.high.z);
}

}  // namespace neuvv::interchange
