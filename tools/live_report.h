// What a training run shows of itself besides the progress line: a preview image and a log of its numbers.
#pragma once

#include <filesystem>
#include <optional>

#include "training/metrics_log.h"

namespace neuvv::tools {

struct LiveOptions {
    std::filesystem::path preview;  // PNG; empty: none
    std::filesystem::path metrics;  // JSON Lines; empty: none
};

// Throws InputError where one of the files could not be written, or is not named as such a file.
void prepare_live_outputs(const LiveOptions& options);

class LiveReport {
  public:
    // Loads a held-out image where a preview is wanted; a data set without any gives one of the training's.
    LiveReport(const gpu::Device& device, const training::Dataset& training, const training::LoadOptions& load,
               LiveOptions options);

    // Call with every report of the run. Previews take at most a twentieth of the time. A preview that fails, for
    // instance for want of device memory, or a line of the log, for want of disk, is the last, and the run goes on.
    void update(const training::TrainProgress& now);

  private:
    void write_preview_if_due(const training::TrainProgress& now);

    const gpu::Device& device_;
    LiveOptions options_;
    training::Dataset shown_;
    std::optional<training::MetricsLog> log_;
    std::optional<training::PreviewScore> score_;
    double previewed_at_ = -1e9, preview_took_ = 0;  // seconds of the run
};

}  // namespace neuvv::tools
