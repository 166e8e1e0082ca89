#include "training/tree/pixel_mask.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace neuvv::training {

namespace {

double cross(const glm::dvec2& origin, const glm::dvec2& a, const glm::dvec2& b) {
    return (a.x - origin.x) * (b.y - origin.y) - (a.y - origin.y) * (b.x - origin.x);
}

// The corners of the convex hull of points, by Andrew's monotone chain.
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points) {
    const auto before = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
    std::ranges::sort(points, before);
    std::vector<glm::dvec2> hull;
    for (int half = 0; half < 2; ++half) {
        const size_t first = hull.size();
        for (const glm::dvec2& point : points) {
            while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
            hull.push_back(point);
        }
        hull.pop_back();  // begins the other half
        std::ranges::reverse(points);
    }
    return hull;
}

// Sets the pixels whose centres are inside a convex polygon or within half a pixel of it.
void fill(PixelMask& mask, const std::vector<glm::dvec2>& polygon) {
    double top = mask.height, bottom = -1;
    for (const glm::dvec2& corner : polygon) {
        top = std::min(top, corner.y);
        bottom = std::max(bottom, corner.y);
    }
    for (auto y = static_cast<uint32_t>(top); y <= bottom; ++y) {
        double left = mask.width, right = -1;
        for (size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            if (std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
            const bool level = a.y == b.y;
            const double at = level ? a.x : a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y);
            left = std::min({left, at, level ? b.x : at});
            right = std::max({right, at, level ? b.x : at});
        }
        for (auto x = static_cast<int64_t>(std::lround(left)); x <= std::lround(right); ++x)
            mask.set[size_t{y} * mask.width + static_cast<size_t>(x)] = 1;
    }
}

}  // namespace

PixelMask inverse(PixelMask mask) {
    for (uint8_t& pixel : mask.set) pixel = 1 - pixel;
    return mask;
}

PixelSums sums_of(const PixelMask& mask) {
    return {mask.width, mask.height, [&](const auto& add) {
                for (size_t i = 0; i < mask.size(); ++i)
                    if (mask[i]) add(static_cast<uint32_t>(i % mask.width), static_cast<uint32_t>(i / mask.width));
            }};
}

PixelMask grown(const PixelMask& mask, uint32_t radius) {
    const PixelSums sums = sums_of(mask);
    PixelMask result(mask.width, mask.height);
    for (uint32_t y = 0; y < mask.height; ++y)
        for (uint32_t x = 0; x < mask.width; ++x) {
            const PixelRectangle around{x - std::min(x, radius), y - std::min(y, radius),
                                        std::min(mask.width, x + radius + 1), std::min(mask.height, y + radius + 1)};
            result.set[size_t{y} * mask.width + x] = sums.count(around) > 0;
        }
    return result;
}

PixelMask shrunk(const PixelMask& mask, uint32_t radius) {
    return inverse(grown(inverse(mask), radius));
}

PixelMask closed(const PixelMask& mask, uint32_t radius) {
    return shrunk(grown(mask, radius), radius);
}

void for_each_part(const PixelMask& mask, const std::function<void(const std::vector<size_t>& part)>& visit) {
    std::vector<uint8_t> seen(mask.size());
    std::vector<size_t> part;
    for (size_t start = 0; start < mask.size(); ++start) {
        if (seen[start] || !mask[start]) continue;
        part.assign(1, start);
        seen[start] = 1;
        for (size_t i = 0; i < part.size(); ++i)
            for_each_neighbour(mask, part[i], true, [&](size_t next) {
                if (seen[next] || !mask[next]) return;
                seen[next] = 1;
                part.push_back(next);
            });
        visit(part);
    }
}

PixelMask without_specks(const PixelMask& mask, size_t speck) {
    PixelMask result = mask;
    for_each_part(mask, [&](const std::vector<size_t>& part) {
        if (part.size() <= speck)
            for (const size_t pixel : part) result.set[pixel] = 0;
    });
    return result;
}

PixelMask convex_parts(const PixelMask& mask, uint32_t reach, size_t speck) {
    PixelMask result(mask.width, mask.height);
    for_each_part(grown(mask, reach), [&](const std::vector<size_t>& part) {
        std::vector<glm::dvec2> points;
        for (const size_t pixel : part)
            if (mask[pixel]) points.emplace_back(pixel % mask.width, pixel / mask.width);
        if (points.size() <= std::max<size_t>(speck, 2)) return;
        const std::vector<glm::dvec2> hull = convex_hull(std::move(points));
        if (hull.size() >= 3) fill(result, hull);
    });
    return result;
}

PixelMask enclosed(const PixelMask& walls, const PixelMask& limit) {
    PixelMask reached = inverse(limit);
    std::vector<size_t> open;
    for (size_t i = 0; i < reached.size(); ++i)
        if (reached[i]) open.push_back(i);
    while (!open.empty()) {
        const size_t at = open.back();
        open.pop_back();
        for_each_neighbour(reached, at, false, [&](size_t next) {
            if (reached[next] || walls[next]) return;
            reached.set[next] = 1;
            open.push_back(next);
        });
    }
    return inverse(reached);
}

}  // namespace neuvv::training
