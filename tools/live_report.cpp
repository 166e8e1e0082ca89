#include "tools/live_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "tools/options.h"
#include "training/preview.h"

namespace neuvv::tools {

namespace {

constexpr double kPreviewEvery = 3, kPreviewShare = 0.05;  // seconds; of the time

void expect_extension(const char* option, const std::filesystem::path& file, const char* extension) {
    if (file.extension() != extension)
        throw InputError(option, file.string(), fmt::format("is no name of a {} file", extension),
                         fmt::format("write for instance run{}", extension));
    prepare_output_file(option, file);
}

training::Dataset shown_dataset(const training::Dataset& training, const training::LoadOptions& load) {
    try {
        return training::preview_dataset(training::load_dataset(training.folder, training::Split::kTest, load));
    } catch (const std::runtime_error& error) {
        fmt::print(stderr, "the preview shows a training image, as no held-out one can be read: {}\n", error.what());
        return training::preview_dataset(training);
    }
}

}  // namespace

void prepare_live_outputs(const LiveOptions& options) {
    if (!options.preview.empty()) expect_extension("--preview", options.preview, ".png");
    if (!options.metrics.empty()) expect_extension("--metrics", options.metrics, ".jsonl");
}

LiveReport::LiveReport(const gpu::Device& device, const training::Dataset& training, const training::LoadOptions& load,
                       LiveOptions options)
    : device_(device), options_(std::move(options)) {
    if (!options_.preview.empty()) shown_ = shown_dataset(training, load);
}

void LiveReport::update(const training::TrainProgress& now) {
    write_preview_if_due(now);
    if (options_.metrics.empty()) return;
    try {
        if (!log_) log_.emplace(options_.metrics, now.began_at_step);
        log_->add(now, score_);
    } catch (const RuntimeFailure& failure) {  // a run is worth more than its log
        fmt::print(stderr, "\nno more metrics: {}\n", failure.what());
        options_.metrics.clear();
    }
}

void LiveReport::write_preview_if_due(const training::TrainProgress& now) {
    using Clock = std::chrono::steady_clock;
    const double wait = std::max(kPreviewEvery, preview_took_ / kPreviewShare);
    if (options_.preview.empty() || now.elapsed_s - previewed_at_ < wait) return;
    const Clock::time_point begin = Clock::now();
    try {
        const training::Quality quality = training::write_preview(device_, *now.field, shown_, options_.preview);
        score_ = training::PreviewScore{shown_.views[0].name, quality.psnr};
    } catch (const RuntimeFailure& failure) {
        fmt::print(stderr, "\nno more previews: {}\n", failure.what());
        options_.preview.clear();
    }
    preview_took_ = std::chrono::duration<double>(Clock::now() - begin).count();
    previewed_at_ = now.elapsed_s + preview_took_;
}

}  // namespace neuvv::tools
