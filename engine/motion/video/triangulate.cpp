#include "motion/video/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "motion/skeleton/median.h"

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

double guessed_height(std::span<const stage::Camera> cameras, std::span<const KeyPoints> points) {
    constexpr double kUsual_m = 1.7;
    const std::optional<glm::dvec3> centre = point_looked_at(cameras);
    if (!centre) return kUsual_m;
    std::vector<double> heights;
    for (size_t i = 0; i < points.size(); ++i) {
        double low = INFINITY, high = -INFINITY;
        for (const KeyPoint& point : points[i]) {
            if (!(point.confidence > 0)) continue;
            low = std::min(low, point.pixel.y);
            high = std::max(high, point.pixel.y);
        }
        if (high > low) heights.push_back((high - low) * metres_per_pixel(cameras[i % cameras.size()], *centre));
    }
    const double height = median(heights);
    return height > 0 ? height : kUsual_m;
}

namespace {

// The views of one joint, and where they see it.
class JointViews {
  public:
    JointViews(std::span<const stage::Camera> cameras, std::span<const KeyPoint> points, double tolerance_m)
        : cameras_(cameras), points_(points), tolerance_m_(tolerance_m), rays_(cameras.size()) {
        for (size_t c = 0; c < cameras.size(); ++c) {
            if (!(points[c].confidence > 0)) continue;
            rays_[c] = ray_through(cameras[c], points[c].pixel);
            seen_.push_back(c);
        }
    }

    const std::vector<size_t>& seen() const { return seen_; }

    std::vector<size_t> agreeing_with(const glm::dvec3& point) const {
        std::vector<size_t> views;
        for (const size_t c : seen_)
            if (error(c, point) < tolerance_m_) views.push_back(c);
        return views;
    }

    // How many views agree, then how well: the sum of 1 − (error/tolerance)² over them, weighted by confidence.
    std::pair<size_t, double> agreement(const glm::dvec3& point) const {
        std::pair<size_t, double> agree{0, 0};
        for (const size_t c : seen_) {
            const double ratio = error(c, point) / tolerance_m_;
            if (!(ratio < 1)) continue;
            ++agree.first;
            agree.second += points_[c].confidence * (1 - ratio * ratio);
        }
        return agree;
    }

    // The point nearest to the rays, in metres, as detectors err by a share of the body and not by pixels.
    std::optional<glm::dvec3> nearest(std::span<const size_t> views) const {
        NearestPoint nearest;
        for (const size_t c : views) nearest.add(rays_[c], points_[c].confidence);
        return nearest.point();
    }

  private:
    double error(size_t camera, const glm::dvec3& point) const {
        const std::optional<glm::dvec2> shown = project(cameras_[camera], point);
        return shown ? glm::distance(*shown, points_[camera].pixel) * metres_per_pixel(cameras_[camera], point)
                     : INFINITY;
    }

    std::span<const stage::Camera> cameras_;
    std::span<const KeyPoint> points_;
    double tolerance_m_;
    std::vector<Ray> rays_;
    std::vector<size_t> seen_;
};

}  // namespace

std::optional<Triangulated> triangulate(std::span<const stage::Camera> cameras, std::span<const KeyPoint> points,
                                        double tolerance_m) {
    const JointViews views(cameras, points, tolerance_m);
    std::optional<glm::dvec3> best;
    std::pair<size_t, double> best_agreement{1, INFINITY};  // of at least two
    const auto consider = [&](std::span<const size_t> some) {
        const std::optional<glm::dvec3> point = views.nearest(some);
        if (!point) return false;
        const auto found = views.agreement(*point);
        if (!(found > best_agreement)) return false;
        best = point, best_agreement = found;
        return true;
    };
    const std::vector<size_t>& seen = views.seen();
    if (seen.size() > 2) consider(seen);
    for (size_t i = 0; i < seen.size(); ++i)
        for (size_t j = i + 1; j < seen.size(); ++j) consider(std::array{seen[i], seen[j]});
    if (!best) return std::nullopt;
    // The point of more views is a better one, with which others may agree, too.
    constexpr int kRounds = 5;
    for (int round = 0; round < kRounds && consider(views.agreeing_with(*best)); ++round) {
    }

    Triangulated result;
    result.agrees.assign(cameras.size(), false);
    const std::vector<size_t> agreeing = views.agreeing_with(*best);
    double confidence = 0;
    for (const size_t c : agreeing) {
        result.agrees[c] = true;
        confidence += points[c].confidence;
    }
    result.views = agreeing.size();
    result.position = views.nearest(agreeing).value_or(*best);
    result.confidence = confidence / static_cast<double>(result.views);
    return result;
}

}  // namespace neuvv::motion
