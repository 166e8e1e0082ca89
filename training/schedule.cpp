#include "training/schedule.h"

#include <algorithm>
#include <cmath>

namespace neuvv::training {

LearningRates learning_rates(double progress) {
    const auto decay = [&](double first, double last) {
        return static_cast<float>(first * std::pow(last / first, std::clamp(progress, 0.0, 1.0)));
    };
    LearningRates rates;
    rates.sigma = decay(0.07, 0.03);
    rates.colour = decay(0.4, 0.04);
    rates.detail = decay(0.05, 0.005);
    rates.gamma = decay(0.5, 0.05);
    rates.sigma_rows = decay(1e-3, 1e-4);
    rates.gamma_rows = decay(1e-3, 1e-4);
    return rates;
}

}  // namespace neuvv::training
