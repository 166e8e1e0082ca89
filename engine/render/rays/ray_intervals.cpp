#include "render/rays/ray_intervals.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "shared/intervals.h"
#include "voctree/files/half.h"

namespace neuvv::render {

namespace {

// light_of_bits of light_bits.glsl
glm::vec3 light_of_bits(uint32_t bits) {
    const glm::vec3 parts(glm::uvec3(bits, bits >> 9, bits >> 18) & 511u);
    return std::ldexp(1.0f, static_cast<int>(bits >> 27) - 15 - 9) * parts;
}

glm::vec2 halves_of(uint32_t word) {
    return {voctree::float_from_half(static_cast<uint16_t>(word)),
            voctree::float_from_half(static_cast<uint16_t>(word >> 16))};
}

RayInterval interval_of(const glm::uvec4& words, const glm::vec3& light) {
    const glm::vec2 first = halves_of(words.z), second = halves_of(words.w);
    RayInterval interval;
    interval.near_m = std::bit_cast<float>(words.x);
    interval.far_m = std::bit_cast<float>(words.y);
    interval.optical_depth = first.x;
    interval.colour = light * glm::vec3(first.y, second.x, second.y);
    return interval;
}

// The intervals of one instance, and the one that the merge has come to.
using Cursor = std::span<const RayInterval>;

std::vector<Cursor> cursors_of(std::span<const RayInterval> intervals) {
    std::vector<Cursor> cursors;
    for (size_t begin = 0, end = 0; begin < intervals.size(); begin = end) {
        while (end < intervals.size() && intervals[end].instance == intervals[begin].instance) ++end;
        cursors.push_back(intervals.subspan(begin, end - begin));
    }
    return cursors;
}

float sigma_of(const RayInterval& interval) {
    return interval.optical_depth / (interval.far_m - interval.near_m);
}

void add_seen(MergedRay& ray, uint32_t performer, float share) {
    const auto known = std::find_if(ray.seen.begin(), ray.seen.end(),
                                    [&](const SeenPerformer& seen) { return seen.performer == performer; });
    if (known == ray.seen.end())
        ray.seen.push_back({performer, share});
    else
        known->share += share;
}

}  // namespace

MergedRay merge_intervals(std::span<const RayInterval> intervals, float stop) {
    constexpr float kEnd = std::numeric_limits<float>::infinity();
    std::vector<Cursor> cursors = cursors_of(intervals);
    MergedRay ray;
    float begin = 0, transmittance = 1;
    while (transmittance >= stop) {
        float end = kEnd, sigma = 0;
        glm::vec3 colour(0);
        const auto is_here = [&](const Cursor& cursor) { return !cursor.empty() && cursor[0].near_m <= begin; };
        for (Cursor& cursor : cursors) {
            while (!cursor.empty() && cursor[0].far_m <= begin) cursor = cursor.subspan(1);
            if (cursor.empty()) continue;
            end = std::min(end, is_here(cursor) ? cursor[0].far_m : cursor[0].near_m);
            if (!is_here(cursor)) continue;
            sigma += sigma_of(cursor[0]);
            colour += sigma_of(cursor[0]) * cursor[0].colour;
        }
        if (end == kEnd) break;
        if (sigma > 0) {
            const float after = transmittance * std::exp(-sigma * (end - begin)), share = transmittance - after;
            if (share > 0) ray.stretches.push_back({begin, end, transmittance, after, share / sigma * colour});
            for (const Cursor& cursor : cursors)
                if (share > 0 && is_here(cursor))
                    add_seen(ray, cursor[0].performer, share * sigma_of(cursor[0]) / sigma);
            transmittance = after;
        }
        begin = end;
    }
    return ray;
}

void read_intervals(const IntervalPages& pages, uint32_t first, std::vector<RayInterval>& intervals) {
    for (uint32_t list = first; list != 0; list = pages.texels[size_t{list} * kPageWords].y) {
        const auto owner = std::lower_bound(pages.pages_after.begin(), pages.pages_after.end(), list);
        assert(owner != pages.pages_after.end() && "an instance has each page");
        const auto instance = static_cast<uint32_t>(owner - pages.pages_after.begin());
        const glm::vec3 light = light_of_bits(pages.texels[size_t{list} * kPageWords].z);
        for (uint32_t page = list; page != 0;) {
            const glm::uvec4* texels = &pages.texels[size_t{page} * kPageWords];
            const bool last = (texels[0].x & kLastPage) != 0;
            const uint32_t count = last ? texels[0].x & ~kLastPage : kPageIntervals;
            for (uint32_t i = 1; i <= count; ++i) {
                intervals.push_back(interval_of(texels[i], light));
                intervals.back().instance = instance;
                intervals.back().performer = pages.performers[instance];
            }
            page = last ? 0 : texels[0].x;
        }
    }
}

}  // namespace neuvv::render
