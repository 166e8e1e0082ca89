#include "reference/adam.h"

#include <cmath>

namespace neuvv::reference {

double adam_bias(double beta, unsigned step) {
    return 1 - std::pow(beta, step);
}

void adam_update(AdamElement& element, double gradient, const AdamSettings& settings, double bias1, double bias2) {
    if (gradient == 0) return;
    element.m = settings.beta1 * element.m + (1 - settings.beta1) * gradient;
    element.v = settings.beta2 * element.v + (1 - settings.beta2) * gradient * gradient;
    const double m_hat = element.m / bias1;
    const double v_hat = element.v / bias2;
    element.weight -= settings.learning_rate * m_hat / (std::sqrt(v_hat) + settings.epsilon);
}

}  // namespace neuvv::reference
