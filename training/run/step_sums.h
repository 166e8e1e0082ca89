// Losses and speed of the steps since the last report.
#pragma once

#include "training/run/train.h"

namespace neuvv::training {

// Owns the sums over these steps, and the last report, which stands until there is a step after it.
class StepSums {
  public:
    // Begins to measure the speed.
    void begin();
    void add(const StepResult& result, const LossWeights& weights);
    // A second has passed since the last report.
    bool is_report_due() const;
    void write_to(TrainProgress& progress) const;
    // Begins again after a report.
    void begin_after(const TrainProgress& reported);

  private:
    double loss_ = 0, rgb_ = 0, grad_ = 0, rays_ = 0, steps_ = 0, began_ = 0;
    TrainProgress reported_;
};

}  // namespace neuvv::training
