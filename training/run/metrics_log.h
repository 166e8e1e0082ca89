// A log of a training run: a file with one JSON object per line (JSON Lines), which can be plotted while the run goes
// on.
//
//   step, elapsed_s, epochs, rays_per_s   how far the run has come, and its speed
//   other_s                               of elapsed_s, what was no step: loading, changes of the tree, checkpoints
//   loss, loss_rgb, loss_grad, batch_psnr of the batches since the last report (TrainProgress)
//   leaves, depth                         of the tree
//   memory_bytes                          peak resident memory of the process
//   preview_psnr, preview_view            of the preview, in lines that are added with one
//   first_frame                           of the segment that is trained, where it is one of a clip's
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "training/run/train.h"

namespace neuvv::training {

struct PreviewScore {
    std::string view;
    double psnr = 0;  // dB, as in Quality
};

class MetricsLog {
  public:
    // Continues `file` for a run that goes on from `began_at_step`: lines of later steps, and lines that are not
    // complete because a run was killed, are removed. A run that begins at step 0 begins the file anew. The run of a
    // segment, with its first frame in the clip, keeps the lines of other segments in any case. No other process may
    // write the file. Throws RuntimeFailure, and InputError where the file that is continued cannot be read.
    MetricsLog(const std::filesystem::path& file, uint64_t began_at_step, std::optional<uint32_t> first_frame = {});

    // Appends a line. Only a crash of the machine can leave it incomplete. Throws RuntimeFailure.
    void add(const TrainProgress& now, const std::optional<PreviewScore>& preview = {}) const;

  private:
    std::filesystem::path file_;
    std::optional<uint32_t> first_frame_;
};

}  // namespace neuvv::training
