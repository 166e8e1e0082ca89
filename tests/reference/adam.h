// Adam (Kingma and Ba 2015) for parameters whose gradient is 0 in most batches.
#pragma once

namespace neuvv::reference {

struct AdamSettings {
    double learning_rate = 1e-2;
    double beta1 = 0.9;
    double beta2 = 0.999;
    double epsilon = 1e-8;
};

struct AdamElement {
    double weight = 0;
    double m = 0;
    double v = 0;
};

// 1 − β^step, where `step` is the global step count, which starts at 1.
double adam_bias(double beta, unsigned step);

// Updates one element. A gradient of exactly 0 leaves the element and its moments as they are, because no ray touched
// its leaf. bias1 and bias2 are adam_bias of the step for β1 and β2.
void adam_update(AdamElement& element, double gradient, const AdamSettings& settings, double bias1, double bias2);

}  // namespace neuvv::reference
