// The rotation that brings one set of directions nearest to another.
#pragma once

#include <glm/glm.hpp>

namespace neuvv::motion {

// Gathers pairs of unit directions with weights (Kabsch's algorithm).
class BestTurn {
  public:
    void add(const glm::dvec3& from, const glm::dvec3& to, double weight) {
        sum_ += weight * glm::outerProduct(to, from);
    }
    // The rotation R with the greatest Σ w to·(R from).
    glm::dmat3 turn() const;

  private:
    glm::dmat3 sum_{0};
};

}  // namespace neuvv::motion
