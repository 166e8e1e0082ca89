#include "training/run/schedule.h"

#include <algorithm>
#include <cmath>

namespace neuvv::training {

namespace {

// From `first` at the beginning to `last` at the end.
float falling(double progress, double first, double last) {
    return static_cast<float>(first * std::pow(last / first, std::clamp(progress, 0.0, 1.0)));
}

}  // namespace

LearningRates learning_rates(double progress, double epochs) {
    const double last = std::clamp(kShortRunEpochs / std::max(epochs, kShortRunEpochs), kLeastLastRate, 1.0);
    LearningRates rates;
    rates.sigma = falling(progress, 0.14, 0.06 * std::sqrt(last));
    rates.colour = falling(progress, 0.4, 0.04 * last);
    rates.detail = falling(progress, 0.05, 0.005 * last);
    rates.gamma = falling(progress, 0.5, 0.05 * last);
    rates.sigma_rows = falling(progress, 1e-3, 1e-4);
    rates.gamma_rows = falling(progress, 1e-3, 1e-4);
    return rates;
}

float smoothness_factor(double squared_error) {
    return static_cast<float>(std::clamp(squared_error / kSmoothedError, 1.0, kMostSmoothing));
}

float camera_colour_rate(double progress) {
    return falling(progress, 0.01, 0.001);
}

}  // namespace neuvv::training
