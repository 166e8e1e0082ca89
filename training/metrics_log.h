// The course of a training run as a file: one JSON object a line (JSON Lines), to plot while the run goes on.
//
//   step, elapsed_s, epochs, rays_per_s   where the run stands
//   loss, loss_rgb, loss_grad, batch_psnr of the batches since the last report (TrainProgress)
//   leaves, depth                         the tree
//   memory_bytes                          peak resident memory of the process
//   preview_psnr, preview_view            of the last preview, in the lines that follow one
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "training/train.h"

namespace neuvv::training {

struct PreviewScore {
    std::string view;
    double psnr = 0;  // dB, whole image over white, as Quality has it
};

class MetricsLog {
  public:
    // Continues `file` for a run that goes on from `began_at_step`: what it holds of later steps, and lines that a kill
    // left incomplete, are dropped. A run that begins at step 0 begins the file anew. Throws RuntimeFailure.
    MetricsLog(const std::filesystem::path& file, uint64_t began_at_step);

    // Appends a line, whole or (on a crash of the machine) in part. Throws RuntimeFailure.
    void add(const TrainProgress& now, const std::optional<PreviewScore>& preview = {}) const;

  private:
    std::filesystem::path file_;
};

}  // namespace neuvv::training
