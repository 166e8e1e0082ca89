#include "render/volume/draw_order.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace neuvv::render {

namespace {

enum class Order { kEither, kFirstBefore, kSecondBefore, kNone };

// The order by a plane perpendicular to this axis (unit length). kNone where no such plane separates the boxes, or
// where eyes are on both sides of it.
Order order_along(const TransformedBox& a, const TransformedBox& b, std::span<const glm::dvec3> eyes, glm::dvec3 axis) {
    const auto half_extent = [axis](const TransformedBox& box) {
        return std::abs(glm::dot(axis, box.half[0])) + std::abs(glm::dot(axis, box.half[1])) +
               std::abs(glm::dot(axis, box.half[2]));
    };
    double from_a = glm::dot(axis, b.centre - a.centre);
    if (from_a < 0) {
        axis = -axis;
        from_a = -from_a;
    }
    const double end_of_a = half_extent(a), begin_of_b = from_a - half_extent(b);  // from a's centre
    if (end_of_a > begin_of_b) return Order::kNone;
    bool all_before_b = true, all_behind_a = true;
    for (const glm::dvec3& eye : eyes) {
        const double at = glm::dot(axis, eye - a.centre);
        all_before_b &= at <= begin_of_b;
        all_behind_a &= at >= end_of_a;
    }
    if (all_before_b && all_behind_a) return Order::kEither;
    return all_before_b ? Order::kFirstBefore : all_behind_a ? Order::kSecondBefore : Order::kNone;
}

Order order_of(const TransformedBox& a, const TransformedBox& b, std::span<const glm::dvec3> eyes) {
    const auto known = [&](glm::dvec3 axis, Order& order) {
        const double length = glm::length(axis);
        if (!(length > 0)) return false;
        order = order_along(a, b, eyes, axis / length);
        return order != Order::kNone;
    };
    Order order = Order::kNone;
    if (known(b.centre - a.centre, order)) return order;  // true for most pairs
    for (const TransformedBox* box : {&a, &b})
        for (int i = 0; i < 3; ++i)
            if (known(glm::cross(box->half[i], box->half[(i + 1) % 3]), order)) return order;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (known(glm::cross(a.half[i], b.half[j]), order)) return order;
    return Order::kNone;
}

// Tarjan's strongly connected components. An edge leads from a box to each box that must be drawn before it, so the
// components are found in draw order. Boxes are visited near to far.
struct Components {
    size_t count;
    std::vector<bool> before;  // [i * count + j]: i must be drawn before j
    std::vector<uint32_t> by_distance;
    std::vector<uint32_t> number, low;
    std::vector<bool> open;
    std::vector<uint32_t> stack;
    uint32_t visited = 0;
    std::vector<std::vector<uint32_t>> groups;

    void visit(uint32_t at) {
        number[at] = low[at] = ++visited;
        stack.push_back(at);
        open[at] = true;
        for (const uint32_t other : by_distance) {
            if (other == at || !before[other * count + at]) continue;
            if (number[other] == 0) {
                visit(other);
                low[at] = std::min(low[at], low[other]);
            } else if (open[other]) {
                low[at] = std::min(low[at], number[other]);
            }
        }
        if (low[at] != number[at]) return;
        groups.emplace_back();
        uint32_t member;
        do {
            member = stack.back();
            stack.pop_back();
            open[member] = false;
            groups.back().push_back(member);
        } while (member != at);
        std::sort(groups.back().begin(), groups.back().end());
    }
};

}  // namespace

TransformedBox transformed_box(glm::dvec3 box_min, glm::dvec3 box_max, const glm::dmat4& world_from_box) {
    const glm::dvec3 centre = 0.5 * (box_min + box_max), half = 0.5 * (box_max - box_min);
    const glm::dmat3 turn(world_from_box);
    return {glm::dvec3(world_from_box * glm::dvec4(centre, 1)),
            glm::dmat3(turn[0] * half.x, turn[1] * half.y, turn[2] * half.z)};
}

std::vector<std::vector<uint32_t>> draw_order(std::span<const TransformedBox> boxes, std::span<const glm::dvec3> eyes) {
    const size_t count = boxes.size();
    Components components{count,
                          std::vector<bool>(count * count),
                          {},
                          std::vector<uint32_t>(count),
                          std::vector<uint32_t>(count),
                          std::vector<bool>(count),
                          {},
                          0,
                          {}};
    std::vector<std::pair<double, uint32_t>> distances;
    for (uint32_t i = 0; i < count; ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const glm::dvec3& eye : eyes) nearest = std::min(nearest, glm::distance(eye, boxes[i].centre));
        distances.emplace_back(nearest, i);
        for (uint32_t j = i + 1; j < count; ++j) {
            const Order order = order_of(boxes[i], boxes[j], eyes);
            components.before[i * count + j] = order == Order::kFirstBefore || order == Order::kNone;
            components.before[j * count + i] = order == Order::kSecondBefore || order == Order::kNone;
        }
    }
    std::sort(distances.begin(), distances.end());
    for (const auto& [distance, i] : distances) components.by_distance.push_back(i);
    for (const uint32_t i : components.by_distance)
        if (components.number[i] == 0) components.visit(i);
    return std::move(components.groups);
}

}  // namespace neuvv::render
