// Frames as Gaussian splats: .ply, .glb and .usda.
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "interchange/splats/splat_gltf.h"
#include "interchange/splats/splat_ply.h"
#include "interchange/splats/splat_usd.h"
#include "tools/export/splat_fit.h"

namespace neuvv::tools {

namespace {

// A kind of file.
struct SplatFormat {
    const char* ending;
    glm::dquat rotation;  // of its axes from ours
    bool holds_many;      // frames in one file
    size_t (*bytes_of_splat)(uint32_t degree);
    void (*write)(const std::filesystem::path& file, std::span<const interchange::Splats> frames, double fps,
                  const glm::dvec3& origin);
};

// Programs for splats read floats alone, so the origin is left out.
void write_ply(const std::filesystem::path& file, std::span<const interchange::Splats> frames, double,
               const glm::dvec3&) {
    interchange::write_splat_ply(file, frames[0]);
}

const std::array<SplatFormat, 3> kFormats = {{
    {".ply", interchange::kPlyRotation, false, interchange::ply_bytes_of_splat, write_ply},
    {".glb", glm::dquat(1, 0, 0, 0), true, interchange::glb_bytes_of_splat, interchange::write_splat_glb},
    {".usda", glm::dquat(1, 0, 0, 0), true, interchange::usda_bytes_of_splat, interchange::write_splat_usda},
}};

class SplatExport : public FrameExport {
  public:
    SplatExport(const ExportOptions& options, const SplatFormat& format, ExportedClip& clip,
                const CommonOptions& common)
        : options_(options), format_(format), clip_(clip), device_(common.device) {}

    bool holds_many() const override { return format_.holds_many; }
    Estimate estimate(uint32_t frame) override;
    void measure(uint32_t frame, const Working& working) override;
    void add(uint32_t frame, const Working& working) override;
    void write(const std::filesystem::path& file) override;
    void report(nlohmann::ordered_json& json) const override;
    std::string summary() const override;

  private:
    const ExportOptions& options_;
    const SplatFormat& format_;
    ExportedClip& clip_;
    gpu::Device device_;
    slice::Slice measured_;                     // from estimate() to measure()
    std::optional<FittedSplats> fit_;           // none where the measured frame is empty
    std::vector<interchange::Splats> waiting_;  // to be written
    uint64_t written_ = 0;                      // splats
};

FrameExport::Estimate SplatExport::estimate(uint32_t frame) {
    measured_ = splat_volume(clip_, frame, options_.most_splats.value_or(0));
    const size_t splats = measured_.leaves.size();
    return {splats * format_.bytes_of_splat(measured_.degree), fmt::format("about {} splats", splats)};
}

void SplatExport::measure(uint32_t frame, const Working& working) {
    if (measured_.leaves.empty()) return;
    fit_ = fit_splats(device_, options_, clip_.still(frame), std::exchange(measured_, {}), working);
}

void SplatExport::add(uint32_t frame, const Working&) {
    const interchange::SplatShape shape = fit_ ? fit_->shape : interchange::SplatShape{};
    waiting_.push_back(interchange::splats_of(splat_volume(clip_, frame, options_.most_splats.value_or(0)), shape,
                                              format_.rotation * clip_.rotation(frame)));
    const auto unit = static_cast<float>(clip_.capture().unit);
    for (interchange::Splat& splat : waiting_.back().splats) {
        splat.centre *= unit;
        splat.deviation *= unit;
    }
}

void SplatExport::write(const std::filesystem::path& file) {
    format_.write(file, waiting_, clip_.fps(), clip_.capture().origin);
    for (const interchange::Splats& splats : waiting_) written_ += splats.splats.size();
    waiting_.clear();
}

void SplatExport::report(nlohmann::ordered_json& json) const {
    json["splats"] = written_;
    if (!fit_) return;
    json["psnr_db"] = fit_->psnr;
    json["close_psnr_db"] = fit_->close_psnr;
    json["width"] = fit_->shape.width;
    json["density"] = fit_->shape.density;
}

std::string SplatExport::summary() const {
    const std::string left_out = format_.holds_many ? "" : origin_text(clip_.capture());
    if (!fit_) return fmt::format("{} splats{}", written_, left_out);
    return fmt::format("{} splats; images of the middle frame have {:.1f} dB, close-ups {:.1f} dB{}", written_,
                       fit_->psnr, fit_->close_psnr, left_out);
}

}  // namespace

std::unique_ptr<FrameExport> export_splats(const ExportOptions& options, const std::string& ending, ExportedClip& clip,
                                           const CommonOptions& common) {
    for (const SplatFormat& format : kFormats)
        if (ending == format.ending) return std::make_unique<SplatExport>(options, format, clip, common);
    return nullptr;
}

}  // namespace neuvv::tools
