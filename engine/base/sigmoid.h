// The sigmoid function, which the hyper angle, colours and opacities are coded by.
#pragma once

#include <cmath>
#include <concepts>

namespace neuvv {

// In (0, 1); 0 or 1 where x is so far from 0 that the value rounds to them.
template <std::floating_point Number>
Number sigmoid(Number x) {
    return 1 / (1 + std::exp(-x));
}

}  // namespace neuvv
