#include "training/schedule.h"

#include <algorithm>
#include <cmath>

namespace neuvv::training {

namespace {

// From `first` at the beginning to `last` at the end.
float falling(double progress, double first, double last) {
    return static_cast<float>(first * std::pow(last / first, std::clamp(progress, 0.0, 1.0)));
}

}  // namespace

LearningRates learning_rates(double progress) {
    LearningRates rates;
    rates.sigma = falling(progress, 0.07, 0.03);
    rates.colour = falling(progress, 0.4, 0.04);
    rates.detail = falling(progress, 0.05, 0.005);
    rates.gamma = falling(progress, 0.5, 0.05);
    rates.sigma_rows = falling(progress, 1e-3, 1e-4);
    rates.gamma_rows = falling(progress, 1e-3, 1e-4);
    return rates;
}

float camera_colour_rate(double progress) {
    return falling(progress, 0.01, 0.001);
}

}  // namespace neuvv::training
