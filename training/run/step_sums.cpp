#include "training/run/step_sums.h"

#include <algorithm>
#include <cmath>

#include "base/seconds.h"

namespace neuvv::training {

void StepSums::begin() {
    began_ = seconds_now();
}

void StepSums::add(const StepResult& result, const LossWeights& weights) {
    rays_ += static_cast<double>(result.pixels);
    rgb_ += result.rgb_loss;
    grad_ += result.grad_loss;
    loss_ += result.total(weights);
    ++steps_;
}

bool StepSums::is_report_due() const {
    return seconds_now() - began_ >= 1;
}

void StepSums::write_to(TrainProgress& progress) const {
    progress.rays_per_s = reported_.rays_per_s;
    progress.loss = reported_.loss;
    progress.psnr = reported_.psnr;
    progress.rgb_loss = reported_.rgb_loss;
    progress.grad_loss = reported_.grad_loss;
    if (steps_ == 0) return;
    progress.rays_per_s = rays_ / std::max(seconds_now() - began_, 1e-3);
    progress.loss = loss_ / steps_;
    progress.rgb_loss = rgb_ / steps_;
    progress.grad_loss = grad_ / steps_;
    progress.psnr = -10 * std::log10(std::max(rgb_ / steps_ / 3, 1e-10));
}

void StepSums::begin_after(const TrainProgress& reported) {
    reported_ = reported;
    loss_ = rgb_ = grad_ = rays_ = steps_ = 0;
    begin();
}

}  // namespace neuvv::training
