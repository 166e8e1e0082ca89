// Points and transforms that are equal but for rounding.
#pragma once

#include <gtest/gtest.h>

#include <glm/glm.hpp>

namespace neuvv::test {

inline void expect_near(const glm::dvec3& a, const glm::dvec3& b, double within = 1e-9) {
    EXPECT_LT(glm::length(a - b), within)
        << a.x << ' ' << a.y << ' ' << a.z << " instead of " << b.x << ' ' << b.y << ' ' << b.z;
}

inline void expect_near(const glm::dmat4& a, const glm::dmat4& b, double within = 1e-9) {
    for (int i = 0; i < 4; ++i) EXPECT_LT(glm::length(a[i] - b[i]), within) << "column " << i;
}

}  // namespace neuvv::test
