#include "motion/video/triangulate.h"

#include <cmath>

namespace neuvv::motion {

namespace {

struct Ray {
    glm::dvec3 origin, direction;  // unit
};

Ray ray_through(const stage::Camera& camera, glm::dvec2 pixel) {
    const glm::dvec3 local((pixel.x - camera.cx) / camera.fx, (camera.cy - pixel.y) / camera.fy, -1);
    return {camera.world_from_camera[3], glm::normalize(glm::dmat3(camera.world_from_camera) * local)};
}

// The point with the least sum of squared weighted distances to lines. It does not exist where all are parallel.
class NearestPoint {
  public:
    void add(const Ray& ray, double weight) {
        const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(ray.direction, ray.direction);
        matrix_ += weight * across;
        sum_ += weight * (across * ray.origin);
        total_ += weight;
    }
    std::optional<glm::dvec3> point() const {
        // The determinant of the mean matrix is sin² of the angle between two rays, times a quarter.
        constexpr double kLeastDeterminant = 1e-5;
        if (!(std::abs(glm::determinant(matrix_ / total_)) > kLeastDeterminant)) return std::nullopt;
        return glm::inverse(matrix_) * sum_;
    }

  private:
    glm::dmat3 matrix_{0};
    glm::dvec3 sum_{0};
    double total_ = 0;
};

}  // namespace

std::optional<glm::dvec2> project(const stage::Camera& camera, const glm::dvec3& point) {
    const glm::dvec3 local =
        glm::transpose(glm::dmat3(camera.world_from_camera)) * (point - glm::dvec3(camera.world_from_camera[3]));
    if (!(local.z < 0)) return std::nullopt;
    return glm::dvec2(camera.cx - camera.fx * local.x / local.z, camera.cy + camera.fy * local.y / local.z);
}

double metres_per_pixel(const stage::Camera& camera, const glm::dvec3& point) {
    return glm::distance(point, glm::dvec3(camera.world_from_camera[3])) / std::sqrt(camera.fx * camera.fy);
}

std::optional<glm::dvec3> point_looked_at(std::span<const stage::Camera> cameras) {
    NearestPoint nearest;
    for (const stage::Camera& camera : cameras)
        nearest.add({camera.world_from_camera[3], -glm::dvec3(camera.world_from_camera[2])}, 1);
    return cameras.empty() ? std::nullopt : nearest.point();
}

std::optional<Triangulated> triangulate(std::span<const stage::Camera> cameras, std::span<const KeyPoint> points,
                                        double tolerance_m) {
    std::vector<size_t> seen;
    std::vector<Ray> rays(cameras.size());
    for (size_t c = 0; c < cameras.size(); ++c) {
        if (!(points[c].confidence > 0)) continue;
        rays[c] = ray_through(cameras[c], points[c].pixel);
        seen.push_back(c);
    }
    const auto error = [&](size_t camera, const glm::dvec3& point) {
        const std::optional<glm::dvec2> shown = project(cameras[camera], point);
        return shown ? glm::distance(*shown, points[camera].pixel) * metres_per_pixel(cameras[camera], point)
                     : INFINITY;
    };
    // How many views agree, then how well: the sum of 1 − (error/tolerance)² over them, weighted by confidence.
    const auto agreement = [&](const glm::dvec3& point) {
        std::pair<size_t, double> agree{0, 0};
        for (const size_t c : seen) {
            const double ratio = error(c, point) / tolerance_m;
            if (!(ratio < 1)) continue;
            ++agree.first;
            agree.second += points[c].confidence * (1 - ratio * ratio);
        }
        return agree;
    };
    std::optional<glm::dvec3> best;
    std::pair<size_t, double> best_agreement{1, INFINITY};  // of at least two
    for (size_t i = 0; i < seen.size(); ++i) {
        for (size_t j = i + 1; j < seen.size(); ++j) {
            NearestPoint nearest;
            nearest.add(rays[seen[i]], 1);
            nearest.add(rays[seen[j]], 1);
            const std::optional<glm::dvec3> point = nearest.point();
            if (!point) continue;
            if (const auto found = agreement(*point); found > best_agreement) best = point, best_agreement = found;
        }
    }
    if (!best) return std::nullopt;

    Triangulated result;
    result.agrees.assign(cameras.size(), false);
    NearestPoint nearest;
    double weights = 0;
    for (const size_t c : seen) {
        if (!(error(c, *best) < tolerance_m)) continue;
        result.agrees[c] = true;
        ++result.views;
        const double scale = metres_per_pixel(cameras[c], *best);
        nearest.add(rays[c], points[c].confidence / (scale * scale));
        weights += points[c].confidence;
    }
    result.position = nearest.point().value_or(*best);
    result.confidence = weights / static_cast<double>(result.views);
    return result;
}

}  // namespace neuvv::motion
