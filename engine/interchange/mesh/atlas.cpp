#include "interchange/mesh/atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace neuvv::interchange {

namespace {

constexpr float kLeastCosine = 0.5f;  // of a triangle's normal with the axis of its chart
constexpr uint32_t kNoChart = UINT32_MAX;
constexpr int kScaleSteps = 16;

using Flat = std::array<glm::vec2, 3>;  // a projected triangle

struct Chart {
    glm::vec3 u{0}, v{0};  // axes of its plane, in which triangles stay counter-clockwise
    std::vector<uint32_t> triangles;
    glm::vec2 low{0}, high{0};  // metres
    glm::ivec2 first_px{0};
};

// How deep two triangles overlap along the normals of the first one's edges: the least of them; ≤ 0: not at all.
float overlap_along(const Flat& a, const Flat& b) {
    float least = std::numeric_limits<float>::max();
    for (size_t i = 0; i < 3; ++i) {
        const glm::vec2 edge = a[(i + 1) % 3] - a[i];
        const float length = glm::length(edge);
        if (!(length > 0)) return 0;
        const glm::vec2 outwards = glm::vec2(edge.y, -edge.x) / length;
        float nearest = std::numeric_limits<float>::max();
        for (const glm::vec2& corner : b) nearest = std::min(nearest, glm::dot(outwards, corner - a[i]));
        least = std::min(least, -nearest);
    }
    return least;
}

bool overlap(const Flat& a, const Flat& b, float tolerance) {
    return overlap_along(a, b) > tolerance && overlap_along(b, a) > tolerance;
}

// The triangles of a chart by squares of its plane, to find those that overlap another one.
class FlatGrid {
  public:
    explicit FlatGrid(float square) : square_(square) {}
    bool is_free(const Flat& flat) const {
        bool free = true;
        visit(flat, [&](uint64_t key) {
            const auto found = squares_.find(key);
            if (!free || found == squares_.end()) return;
            for (const Flat& other : found->second) free &= !overlap(flat, other, 1e-3f * square_);
        });
        return free;
    }
    void add(const Flat& flat) {
        visit(flat, [&](uint64_t key) { squares_[key].push_back(flat); });
    }

  private:
    template <typename Each>
    void visit(const Flat& flat, const Each& each) const {
        const glm::ivec2 low(glm::floor(glm::min(glm::min(flat[0], flat[1]), flat[2]) / square_));
        const glm::ivec2 high(glm::floor(glm::max(glm::max(flat[0], flat[1]), flat[2]) / square_));
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x)
                each(uint64_t{static_cast<uint32_t>(y)} << 32 | static_cast<uint32_t>(x));
    }
    float square_;
    std::unordered_map<uint64_t, std::vector<Flat>> squares_;
};

class Charter {
  public:
    explicit Charter(const TriangleMesh& mesh);
    std::vector<Chart> charts(const std::function<void()>& between);

  private:
    Flat flat_of(const Chart& chart, uint32_t triangle) const;
    Chart grow(uint32_t seed, uint32_t index);
    const TriangleMesh& mesh_;
    std::vector<glm::vec3> normals_;                   // of triangles
    std::vector<std::array<uint32_t, 3>> neighbours_;  // beyond each edge
    std::vector<uint32_t> chart_of_;
    float square_ = 1;
};

Charter::Charter(const TriangleMesh& mesh)
    : mesh_(mesh), neighbours_(mesh.triangles.size()), chart_of_(mesh.triangles.size(), kNoChart) {
    std::unordered_map<uint64_t, uint32_t> of_edge;  // the triangle to whose left it is
    double edges_m = 0;
    const auto key = [](uint32_t a, uint32_t b) { return uint64_t{a} << 32 | b; };
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& triangle = mesh.triangles[i];
        const glm::vec3 cross = cross_of(mesh, triangle);
        const float length = glm::length(cross);
        normals_.push_back(length > 0 ? cross / length : glm::vec3(0, 1, 0));
        edges_m += std::sqrt(double{length});
        for (int k = 0; k < 3; ++k) of_edge[key(triangle[k], triangle[(k + 1) % 3])] = i;
    }
    if (edges_m > 0) square_ = static_cast<float>(1.5 * edges_m / static_cast<double>(mesh.triangles.size()));
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const auto found = of_edge.find(key(mesh.triangles[i][(k + 1) % 3], mesh.triangles[i][k]));
            neighbours_[i][static_cast<size_t>(k)] = found == of_edge.end() ? i : found->second;
        }
}

Flat Charter::flat_of(const Chart& chart, uint32_t triangle) const {
    Flat flat;
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& position = mesh_.positions[mesh_.triangles[triangle][k]];
        flat[static_cast<size_t>(k)] = {glm::dot(chart.u, position), glm::dot(chart.v, position)};
    }
    return flat;
}

// The chart of a triangle: its neighbours, and theirs, as long as they fit.
Chart Charter::grow(uint32_t seed, uint32_t index) {
    const glm::vec3 size = glm::abs(normals_[seed]);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const float sign = normals_[seed][axis] < 0 ? -1.0f : 1.0f;
    Chart chart;
    chart.u[(axis + 1) % 3] = sign;
    chart.v[(axis + 2) % 3] = 1;
    FlatGrid grid(square_);
    chart.triangles.push_back(seed);
    chart_of_[seed] = index;
    grid.add(flat_of(chart, seed));
    for (size_t i = 0; i < chart.triangles.size(); ++i)
        for (const uint32_t next : neighbours_[chart.triangles[i]]) {
            if (chart_of_[next] != kNoChart || sign * normals_[next][axis] < kLeastCosine) continue;
            const Flat flat = flat_of(chart, next);
            if (!grid.is_free(flat)) continue;
            grid.add(flat);
            chart_of_[next] = index;
            chart.triangles.push_back(next);
        }
    chart.low = glm::vec2(std::numeric_limits<float>::max());
    chart.high = -chart.low;
    for (const uint32_t triangle : chart.triangles)
        for (const glm::vec2& corner : flat_of(chart, triangle)) {
            chart.low = glm::min(chart.low, corner);
            chart.high = glm::max(chart.high, corner);
        }
    return chart;
}

// Begins with triangles that face an axis most, so that charts end where the surface turns.
std::vector<Chart> Charter::charts(const std::function<void()>& between) {
    std::vector<uint32_t> order(mesh_.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto straightness = [&](uint32_t i) {
        const glm::vec3 size = glm::abs(normals_[i]);
        return std::max({size.x, size.y, size.z});
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return straightness(a) > straightness(b); });
    std::vector<Chart> all;
    for (const uint32_t seed : order) {
        if (chart_of_[seed] != kNoChart) continue;
        if (all.size() % 64 == 0) between();
        all.push_back(grow(seed, static_cast<uint32_t>(all.size())));
    }
    std::sort(all.begin(), all.end(),
              [](const Chart& a, const Chart& b) { return a.high.y - a.low.y > b.high.y - b.low.y; });
    return all;
}

glm::ivec2 size_px(const Chart& chart, float texels_per_m) {
    return glm::ivec2(glm::ceil((chart.high - chart.low) * texels_per_m)) + kAtlasGap_px;
}

// Places the charts, the tallest first, each where it lies highest on those that are there already. False where they do
// not fit.
bool pack(std::vector<Chart>& charts, int side_px, float texels_per_m) {
    std::vector<int> filled(static_cast<size_t>(side_px), 0);  // rows of each column
    for (Chart& chart : charts) {
        const glm::ivec2 size = size_px(chart, texels_per_m);
        if (size.x > side_px) return false;
        glm::ivec2 best(0, side_px);
        for (int x = 0; x + size.x <= side_px;) {
            const auto begin = filled.begin() + x;
            const auto highest = std::max_element(begin, begin + size.x);
            if (*highest < best.y) best = {x, *highest};
            x = static_cast<int>(highest - filled.begin()) + 1;
        }
        if (best.y + size.y > side_px) return false;
        chart.first_px = best;
        std::fill_n(filled.begin() + best.x, size.x, best.y + size.y);
    }
    return true;
}

// The largest scale at which the charts fit, in texels a metre; they are placed by it.
float pack_at_best(std::vector<Chart>& charts, uint32_t side_px, const std::function<void()>& between) {
    double area = 0;
    for (const Chart& chart : charts) {
        const glm::dvec2 size(chart.high - chart.low);
        area += size.x * size.y;
    }
    const int side = static_cast<int>(side_px);
    float fits = 0, fails = static_cast<float>(2 * side / std::sqrt(std::max(area, 1e-20)));
    for (int i = 0; i < kScaleSteps; ++i) {
        between();
        const float centre = 0.5f * (fits + fails);
        (pack(charts, side, centre) ? fits : fails) = centre;
    }
    pack(charts, side, fits);
    return fits;
}

// The point of a triangle that is nearest to another one, by the weights of the triangle's first two corners.
struct Nearest {
    glm::vec2 at;
    float distance;
};
Nearest nearest_on(const Flat& flat, const glm::vec2& point) {
    const glm::vec2 a = flat[0] - flat[2], b = flat[1] - flat[2], p = point - flat[2];
    const float whole = a.x * b.y - a.y * b.x;
    if (whole != 0) {
        const glm::vec2 at((p.x * b.y - p.y * b.x) / whole, (a.x * p.y - a.y * p.x) / whole);
        if (at.x >= 0 && at.y >= 0 && at.x + at.y <= 1) return {at, 0};
    }
    Nearest best{{0, 0}, std::numeric_limits<float>::max()};
    for (size_t i = 0; i < 3; ++i) {
        const glm::vec2 from = flat[i], edge = flat[(i + 1) % 3] - from;
        const float squared = glm::dot(edge, edge);
        const float part = squared > 0 ? std::clamp(glm::dot(point - from, edge) / squared, 0.0f, 1.0f) : 0.0f;
        const float distance = glm::distance(point, from + part * edge);
        if (distance >= best.distance) continue;
        std::array<float, 3> weights{};
        weights[i] = 1 - part;
        weights[(i + 1) % 3] = part;
        best = {{weights[0], weights[1]}, distance};
    }
    return best;
}

}  // namespace

std::optional<MappedMesh> mapped(const TriangleMesh& mesh, uint32_t side_px, const std::function<void()>& between) {
    std::vector<Chart> charts = Charter(mesh).charts(between);
    const float scale = pack_at_best(charts, side_px, between);
    if (!(scale > 0) && !charts.empty()) return std::nullopt;
    const std::vector<glm::vec3> normals = normals_of(mesh);
    MappedMesh to;
    for (const Chart& chart : charts) {
        std::unordered_map<uint32_t, uint32_t> renamed;
        const glm::vec2 first = glm::vec2(chart.first_px) + 0.5f * static_cast<float>(kAtlasGap_px);
        for (const uint32_t index : chart.triangles) {
            glm::uvec3 triangle;
            for (int k = 0; k < 3; ++k) {
                const uint32_t vertex = mesh.triangles[index][k];
                const auto [found, is_new] = renamed.try_emplace(vertex, static_cast<uint32_t>(to.positions.size()));
                triangle[k] = found->second;
                if (!is_new) continue;
                const glm::vec3& position = mesh.positions[vertex];
                const glm::vec2 flat(glm::dot(chart.u, position), glm::dot(chart.v, position));
                to.positions.push_back(position);
                to.normals.push_back(normals[vertex]);
                to.uvs.push_back((first + (flat - chart.low) * scale) / static_cast<float>(side_px));
            }
            to.triangles.push_back(triangle);
        }
    }
    return to;
}

std::vector<Texel> texels_of(const MappedMesh& mesh, uint32_t side_px) {
    constexpr float kReach_px = 1.5f;
    const auto side = static_cast<float>(side_px);
    std::vector<Texel> texels(size_t{side_px} * side_px);
    std::vector<float> distances(texels.size(), kReach_px);
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        Flat flat;
        for (int k = 0; k < 3; ++k) flat[static_cast<size_t>(k)] = side * mesh.uvs[mesh.triangles[i][k]];
        const glm::vec2 low = glm::min(glm::min(flat[0], flat[1]), flat[2]) - kReach_px;
        const glm::vec2 high = glm::max(glm::max(flat[0], flat[1]), flat[2]) + kReach_px;
        const glm::ivec2 first(glm::max(glm::floor(low), 0.0f)), last(glm::min(glm::ceil(high), side - 1));
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x) {
                const Nearest nearest = nearest_on(flat, glm::vec2(x, y) + 0.5f);
                const size_t texel = static_cast<size_t>(y) * side_px + static_cast<size_t>(x);
                if (nearest.distance >= distances[texel]) continue;
                distances[texel] = nearest.distance;
                texels[texel] = {i, nearest.at};
            }
    }
    return texels;
}

}  // namespace neuvv::interchange
