#include "interchange/mesh/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>

namespace neuvv::interchange {

namespace {

// So that flat parts are divided evenly: squared distances between merged vertices count this much.
constexpr double kEvenness = 1e-3;
// The cosine of the largest angle by which a merge may turn a triangle.
constexpr double kLeastTurn = 0.2;
// The smallest 4·√3·area / sum of squared edges that a merge may leave: 1 is equilateral.
constexpr double kLeastShape = 0.05;
constexpr size_t kMergesOfPart = 10000;
constexpr double kLeastDeterminant = 1e-8;  // relative to the cube of the quadric's trace

// The sum of squared distances from planes, weighted by area: xᵀAx + 2bᵀx + c.
struct Quadric {
    glm::dmat3 a{0};
    glm::dvec3 b{0};
    double c = 0;

    void add_plane(const glm::dvec3& normal, double offset, double weight) {
        a += weight * glm::outerProduct(normal, normal);
        b += weight * offset * normal;
        c += weight * offset * offset;
    }
    Quadric operator+(const Quadric& other) const { return {a + other.a, b + other.b, c + other.c}; }
    double at(const glm::dvec3& x) const { return glm::dot(x, a * x) + 2 * glm::dot(b, x) + c; }
    double area() const { return a[0][0] + a[1][1] + a[2][2]; }  // of its planes
};

struct Merge {
    double cost;
    uint32_t from, to;
    uint32_t version_from, version_to;  // of both vertices when it was found
    glm::dvec3 position;
    bool operator>(const Merge& other) const {
        return cost != other.cost ? cost > other.cost : std::pair(from, to) > std::pair(other.from, other.to);
    }
};

class Simplifier {
  public:
    explicit Simplifier(const TriangleMesh& mesh);
    void run(size_t most_triangles, const std::function<void()>& between);
    TriangleMesh result() const;

  private:
    void push(uint32_t a, uint32_t b);
    std::vector<uint32_t> neighbours_of(uint32_t vertex) const;
    bool keeps_topology(uint32_t from, uint32_t to) const;
    bool keeps_sides(uint32_t vertex, uint32_t other, const glm::dvec3& position) const;
    void apply(const Merge& merge);

    std::vector<glm::dvec3> positions_;
    std::vector<glm::uvec3> triangles_;
    std::vector<bool> alive_;                    // of triangles
    std::vector<std::vector<uint32_t>> around_;  // live triangles of each vertex
    std::vector<Quadric> quadrics_;
    std::vector<uint32_t> versions_;
    std::priority_queue<Merge, std::vector<Merge>, std::greater<>> merges_;
    size_t left_;
};

Simplifier::Simplifier(const TriangleMesh& mesh)
    : positions_(mesh.positions.begin(), mesh.positions.end()),
      triangles_(mesh.triangles),
      alive_(mesh.triangles.size(), true),
      around_(mesh.positions.size()),
      quadrics_(mesh.positions.size()),
      versions_(mesh.positions.size(), 0),
      left_(mesh.triangles.size()) {
    for (uint32_t i = 0; i < triangles_.size(); ++i) {
        const glm::uvec3& triangle = triangles_[i];
        const glm::dvec3& a = positions_[triangle[0]];
        const glm::dvec3 cross = glm::cross(positions_[triangle[1]] - a, positions_[triangle[2]] - a);
        const double length = glm::length(cross);
        for (int k = 0; k < 3; ++k) {
            around_[triangle[k]].push_back(i);
            if (length > 0) quadrics_[triangle[k]].add_plane(cross / length, -glm::dot(cross / length, a), length);
        }
    }
    for (const glm::uvec3& triangle : triangles_)
        for (int k = 0; k < 3; ++k)
            if (triangle[k] < triangle[(k + 1) % 3]) push(triangle[k], triangle[(k + 1) % 3]);
}

void Simplifier::push(uint32_t a, uint32_t b) {
    const Quadric sum = quadrics_[a] + quadrics_[b];
    const glm::dvec3 centre = 0.5 * (positions_[a] + positions_[b]);
    const double edge = glm::distance(positions_[a], positions_[b]);
    std::array<glm::dvec3, 4> candidates = {centre, positions_[a], positions_[b], centre};
    const double trace = sum.area();
    if (std::abs(glm::determinant(sum.a)) > kLeastDeterminant * trace * trace * trace) {
        const glm::dvec3 best = glm::inverse(sum.a) * -sum.b;
        if (glm::distance(best, centre) <= edge) candidates[3] = best;
    }
    glm::dvec3 position = centre;
    double least = INFINITY;
    for (const glm::dvec3& candidate : candidates) {
        const double cost = sum.at(candidate) + kEvenness * trace *
                                                    (glm::dot(candidate - positions_[a], candidate - positions_[a]) +
                                                     glm::dot(candidate - positions_[b], candidate - positions_[b]));
        if (cost >= least) continue;
        least = cost;
        position = candidate;
    }
    merges_.push({least, a, b, versions_[a], versions_[b], position});
}

std::vector<uint32_t> Simplifier::neighbours_of(uint32_t vertex) const {
    std::vector<uint32_t> all;
    for (const uint32_t triangle : around_[vertex])
        for (int k = 0; k < 3; ++k)
            if (triangles_[triangle][k] != vertex) all.push_back(triangles_[triangle][k]);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

// The link condition (Dey et al., "Topology preserving edge contraction", 1999): both vertices have two neighbours in
// common, the third corners of their two triangles, which must keep at least three triangles.
bool Simplifier::keeps_topology(uint32_t from, uint32_t to) const {
    const std::vector<uint32_t> a = neighbours_of(from), b = neighbours_of(to);
    std::vector<uint32_t> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    return common.size() == 2 && around_[common[0]].size() > 3 && around_[common[1]].size() > 3;
}

// Whether the triangles of a vertex, without those of the other, keep their side and a fair shape when it moves.
bool Simplifier::keeps_sides(uint32_t vertex, uint32_t other, const glm::dvec3& position) const {
    for (const uint32_t index : around_[vertex]) {
        const glm::uvec3& triangle = triangles_[index];
        if (triangle[0] == other || triangle[1] == other || triangle[2] == other) continue;
        std::array<glm::dvec3, 3> before, after;
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<size_t>(k);
            before[i] = positions_[triangle[k]];
            after[i] = triangle[k] == vertex ? position : before[i];
        }
        const glm::dvec3 was = glm::cross(before[1] - before[0], before[2] - before[0]);
        const glm::dvec3 is = glm::cross(after[1] - after[0], after[2] - after[0]);
        if (!(glm::dot(was, is) > kLeastTurn * glm::length(was) * glm::length(is))) return false;
        double edges = 0;
        for (size_t k = 0; k < 3; ++k) edges += glm::dot(after[(k + 1) % 3] - after[k], after[(k + 1) % 3] - after[k]);
        if (2 * std::sqrt(3.0) * glm::length(is) < kLeastShape * edges) return false;
    }
    return true;
}

void Simplifier::apply(const Merge& merge) {
    positions_[merge.to] = merge.position;
    quadrics_[merge.to] = quadrics_[merge.to] + quadrics_[merge.from];
    for (const uint32_t index : around_[merge.from]) {
        glm::uvec3& triangle = triangles_[index];
        if (triangle[0] == merge.to || triangle[1] == merge.to || triangle[2] == merge.to) {
            for (int k = 0; k < 3; ++k)
                if (triangle[k] != merge.from) std::erase(around_[triangle[k]], index);
            alive_[index] = false;
            --left_;
            continue;
        }
        for (int k = 0; k < 3; ++k)
            if (triangle[k] == merge.from) triangle[k] = merge.to;
        around_[merge.to].push_back(index);
    }
    around_[merge.from].clear();
    ++versions_[merge.from];
    ++versions_[merge.to];
    for (const uint32_t neighbour : neighbours_of(merge.to)) push(neighbour, merge.to);
}

void Simplifier::run(size_t most_triangles, const std::function<void()>& between) {
    for (size_t i = 0; left_ > most_triangles && !merges_.empty(); ++i) {
        if (i % kMergesOfPart == 0) between();
        const Merge merge = merges_.top();
        merges_.pop();
        if (versions_[merge.from] != merge.version_from || versions_[merge.to] != merge.version_to) continue;
        if (!keeps_topology(merge.from, merge.to) || !keeps_sides(merge.from, merge.to, merge.position) ||
            !keeps_sides(merge.to, merge.from, merge.position))
            continue;
        apply(merge);
    }
}

TriangleMesh Simplifier::result() const {
    TriangleMesh mesh{{positions_.begin(), positions_.end()}, {}};
    for (size_t i = 0; i < triangles_.size(); ++i)
        if (alive_[i]) mesh.triangles.push_back(triangles_[i]);
    drop_unused_vertices(mesh);
    return mesh;
}

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, size_t most_triangles, const std::function<void()>& between) {
    if (mesh.triangles.size() <= most_triangles) return mesh;
    Simplifier simplifier(mesh);
    simplifier.run(most_triangles, between);
    return simplifier.result();
}

}  // namespace neuvv::interchange
