#include "training/run/metrics_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxLogBytes = uint64_t{1} << 30;

// Whether a line stays when the run of a segment, or of a whole clip, goes on from a step.
bool is_kept(const std::string& line, uint64_t step, std::optional<uint32_t> first_frame) {
    const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object() || !json.contains("step") || !json["step"].is_number_unsigned()) return false;
    if (first_frame && json.contains("first_frame") && json["first_frame"] != *first_frame) return true;
    return step > 0 && json["step"].get<uint64_t>() <= step;
}

// The complete lines of `file` that stay.
std::string kept_lines(const std::filesystem::path& file, uint64_t step, std::optional<uint32_t> first_frame) {
    std::error_code ignored;
    if ((step == 0 && !first_frame) || !std::filesystem::exists(file, ignored)) return "";
    const std::vector<uint8_t> bytes = read_file(file, kMaxLogBytes);
    std::string kept;
    for (auto begin = bytes.begin(); begin != bytes.end();) {
        const auto end = std::find(begin, bytes.end(), '\n');
        if (end == bytes.end()) break;
        const std::string line(begin, end);
        if (is_kept(line, step, first_frame)) kept += line + "\n";
        begin = end + 1;
    }
    return kept;
}

}  // namespace

MetricsLog::MetricsLog(const std::filesystem::path& file, uint64_t began_at_step, std::optional<uint32_t> first_frame)
    : file_(file), first_frame_(first_frame) {
    const std::string kept = kept_lines(file, began_at_step, first_frame);
    write_file_atomically(file, [&](const ByteSink& sink) { sink(kept.data(), kept.size()); });
}

void MetricsLog::add(const TrainProgress& now, const std::optional<PreviewScore>& preview) const {
    nlohmann::ordered_json json = {
        {"step", now.step},         {"elapsed_s", now.elapsed_s},   {"other_s", now.other_s},
        {"epochs", now.epochs},     {"rays_per_s", now.rays_per_s}, {"loss", now.loss},
        {"loss_rgb", now.rgb_loss}, {"loss_grad", now.grad_loss},   {"batch_psnr", now.psnr},
        {"leaves", now.leaves},     {"depth", now.depth},           {"memory_bytes", peak_memory_bytes()}};
    if (first_frame_) json["first_frame"] = *first_frame_;
    if (preview) {
        json["preview_psnr"] = preview->psnr;
        json["preview_view"] = preview->view;
    }
    std::ofstream out(file_, std::ios::binary | std::ios::app);
    out << json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    out.flush();
    if (!out) throw RuntimeFailure(fmt::format("{}: cannot append to this file", file_.string()));
}

}  // namespace neuvv::training
