#include "editor/draw/set_surface.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace neuvv::editor {

namespace {

// A ray in the space of a piece. The direction has any length: distances along it are those of the world.
struct PieceRay {
    glm::dvec3 origin, direction;
};

// Möller and Trumbore 1997; both sides of the triangle count. Infinite where the ray misses it.
double distance_to_triangle(const PieceRay& ray, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const glm::dvec3 ab = b - a, ac = c - a, across = glm::cross(ray.direction, ac);
    const double volume = glm::dot(ab, across);
    if (volume == 0) return INFINITY;
    const glm::dvec3 from_a = ray.origin - a, turned = glm::cross(from_a, ab);
    const double u = glm::dot(from_a, across) / volume, v = glm::dot(ray.direction, turned) / volume;
    const double t = glm::dot(ac, turned) / volume;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : INFINITY;
}

// Whether a ray comes into a box nearer than `within`. The box may be flat.
bool meets_box(const PieceRay& ray, glm::vec3 low, glm::vec3 high, double within) {
    double enters = 0, leaves = within;
    for (int axis = 0; axis < 3; ++axis) {
        const double from = ray.origin[axis], each = 1 / ray.direction[axis];
        const auto lower = static_cast<double>(low[axis]), upper = static_cast<double>(high[axis]);
        if (ray.direction[axis] == 0) {
            if (from < lower || from > upper) return false;
            continue;
        }
        enters = std::max(enters, std::min((lower - from) * each, (upper - from) * each));
        leaves = std::min(leaves, std::max((lower - from) * each, (upper - from) * each));
    }
    constexpr double kRounding = 1e-9;
    return enters <= leaves * (1 + kRounding) + kRounding;
}

// Calls visit(node, primitive) for each primitive that a scene draws, until it returns false. Returns whether all were
// visited.
template <typename Visit>
bool visit_drawn(const stage::GltfScene& scene, const Visit& visit) {
    for (uint32_t node = 0; node < scene.nodes.size(); ++node) {
        if (!scene.nodes[node].draws_mesh()) continue;
        const auto mesh = static_cast<size_t>(scene.nodes[node].mesh);
        for (const stage::GltfPrimitive& primitive : scene.meshes[mesh].primitives)
            if (!visit(node, primitive)) return false;
    }
    return true;
}

}  // namespace

bool SetSurface::lists_pieces_of(const stage::GltfScene& scene) const {
    size_t next = 0;
    const bool same = visit_drawn(scene, [&](uint32_t node, const stage::GltfPrimitive& primitive) {
        if (next >= pieces_.size()) return false;
        const Piece& piece = pieces_[next++];
        return piece.node == node && piece.primitive == &primitive && piece.has_skin == (scene.nodes[node].skin >= 0);
    });
    return same && next == pieces_.size();
}

void SetSurface::list_pieces(const stage::GltfScene& scene) {
    meshes_ = scene.meshes;
    pieces_.clear();
    visit_drawn(scene, [&](uint32_t node, const stage::GltfPrimitive& primitive) {
        Piece& piece = pieces_.emplace_back();
        piece.node = node;
        piece.primitive = &primitive;
        piece.has_skin = scene.nodes[node].skin >= 0;
        bound(piece);
        return true;
    });
}

void SetSurface::bound(Piece& piece) {
    const std::vector<uint32_t>& indices = piece.primitive->indices;
    const std::vector<glm::vec3>& positions = piece.positions();
    constexpr size_t kCorners = 3 * kRun;
    piece.runs.assign((indices.size() + kCorners - 1) / kCorners, {});
    piece.bounds = {};
    for (size_t i = 0; i < indices.size(); ++i) {
        Bounds& run = piece.runs[i / kCorners];
        run.low = glm::min(run.low, positions[indices[i]]);
        run.high = glm::max(run.high, positions[indices[i]]);
    }
    for (const Bounds& run : piece.runs) {
        piece.bounds.low = glm::min(piece.bounds.low, run.low);
        piece.bounds.high = glm::max(piece.bounds.high, run.high);
    }
}

void SetSurface::pose_piece(Piece& piece, const stage::GltfScene& scene, const stage::PosedScene& pose) {
    const int32_t skin = scene.nodes[piece.node].skin;
    const std::span<const glm::dmat4> joints = skin < 0 ? std::span(&pose.world_from_node[piece.node], 1)
                                                        : std::span(pose.joint_matrices[static_cast<size_t>(skin)]);
    const std::vector<float>& weights = pose.morph_weights[piece.node];
    if (std::equal(joints.begin(), joints.end(), piece.joints.begin(), piece.joints.end()) && weights == piece.weights)
        return;
    piece.piece_from_world = glm::dmat4(1);
    piece.joints.assign(joints.begin(), joints.end());
    piece.weights = weights;
    stage::pose_vertices(scene, pose, piece.node, *piece.primitive, piece.posed);
    bound(piece);
}

void SetSurface::follow(const stage::GltfScene& scene, const stage::PosedScene& pose) {
    if (!lists_pieces_of(scene)) list_pieces(scene);
    for (Piece& piece : pieces_) {
        const glm::dmat4& world_from_node = pose.world_from_node[piece.node];
        const bool is_flat = glm::determinant(glm::dmat3(world_from_node)) == 0;
        const bool is_rigid = !is_flat && !piece.has_skin && piece.primitive->targets.empty();
        if (std::exchange(piece.is_rigid, is_rigid) != is_rigid) {
            piece.joints.clear();
            if (is_rigid) bound(piece);
        }
        if (is_rigid)
            piece.piece_from_world = glm::inverse(world_from_node);
        else
            pose_piece(piece, scene, pose);
    }
}

void SetSurface::meet_piece(const Piece& piece, const Ray& ray, SetHit& nearest) {
    const PieceRay local{glm::dvec3(piece.piece_from_world * glm::dvec4(ray.origin, 1)),
                         glm::dvec3(piece.piece_from_world * glm::dvec4(ray.direction, 0))};
    if (!meets_box(local, piece.bounds.low, piece.bounds.high, nearest.distance_m)) return;
    const std::vector<uint32_t>& indices = piece.primitive->indices;
    const std::vector<glm::vec3>& positions = piece.positions();
    for (size_t run = 0; run < piece.runs.size(); ++run) {
        if (!meets_box(local, piece.runs[run].low, piece.runs[run].high, nearest.distance_m)) continue;
        const size_t end = std::min(indices.size(), 3 * kRun * (run + 1));
        for (size_t i = 3 * kRun * run; i + 2 < end; i += 3) {
            const double metres = distance_to_triangle(local, positions[indices[i]], positions[indices[i + 1]],
                                                       positions[indices[i + 2]]);
            if (metres < nearest.distance_m) nearest = {piece.node, metres};
        }
    }
}

std::optional<SetHit> SetSurface::meet(const Ray& ray) const {
    SetHit nearest{0, INFINITY};
    for (const Piece& piece : pieces_) meet_piece(piece, ray, nearest);
    return std::isfinite(nearest.distance_m) ? std::optional(nearest) : std::nullopt;
}

}  // namespace neuvv::editor
