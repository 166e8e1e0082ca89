// Frames as Gaussian splats: .ply, .glb and .usda.
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "interchange/fit_splats.h"
#include "interchange/shown_leaves.h"
#include "interchange/splat_gltf.h"
#include "interchange/splat_ply.h"
#include "interchange/splat_usd.h"
#include "tools/compared_views.h"
#include "tools/export/exported_clip.h"
#include "tools/export/frame_export.h"
#include "tools/options.h"

namespace neuvv::tools {

namespace {

// A kind of file.
struct SplatFormat {
    const char* ending;
    glm::dquat rotation;  // of its axes from ours
    bool holds_many;      // frames in one file
    size_t (*bytes_of_splat)(uint32_t degree);
    void (*write)(const std::filesystem::path& file, std::span<const interchange::Splats> frames, double fps);
};

void write_ply(const std::filesystem::path& file, std::span<const interchange::Splats> frames, double) {
    interchange::write_splat_ply(file, frames[0]);
}

const std::array<SplatFormat, 3> kFormats = {{
    {".ply", interchange::kPlyRotation, false, interchange::ply_bytes_of_splat, write_ply},
    {".glb", glm::dquat(1, 0, 0, 0), true, interchange::glb_bytes_of_splat, interchange::write_splat_glb},
    {".usda", glm::dquat(1, 0, 0, 0), true, interchange::usda_bytes_of_splat, interchange::write_splat_usda},
}};

constexpr size_t kCloseViews = 4;

const stage::Camera& nearest_camera(const ComparedViews& views, const glm::dvec3& place) {
    size_t nearest = 0;
    for (size_t i = 1; i < views.count(); i++) {
        const auto away = [&](size_t view) {
            return glm::distance(glm::dvec3(views.camera_of(view).world_from_camera[3]), place);
        };
        if (away(i) < away(nearest)) nearest = i;
    }
    return views.camera_of(nearest);
}

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
    interchange::FrameVolume volume_of(uint32_t frame);

    const ExportOptions& options_;
    const SplatFormat& format_;
    ExportedClip& clip_;
    gpu::Device device_;
    interchange::FrameVolume measured_;         // from estimate() to measure()
    std::optional<interchange::SplatFit> fit_;  // none where the measured frame is empty
    double psnr_ = 0;                           // dB, of --views images
    std::vector<interchange::Splats> waiting_;  // to be written
    uint64_t written_ = 0;                      // splats
};

interchange::FrameVolume SplatExport::volume_of(uint32_t frame) {
    interchange::FrameVolume volume = clip_.volume(frame);
    if (options_.most_splats == 0 || volume.leaves.size() <= options_.most_splats) return volume;
    interchange::measure_shown(volume);
    return interchange::with_fewer_leaves(std::move(volume), options_.most_splats);
}

FrameExport::Estimate SplatExport::estimate(uint32_t frame) {
    measured_ = volume_of(frame);
    const size_t splats = measured_.leaves.size();
    return {splats * format_.bytes_of_splat(measured_.degree), fmt::format("about {} splats", splats)};
}

// Finds the shape of all splats by images of the frame.
void SplatExport::measure(uint32_t frame, const Working& working) {
    const interchange::FrameVolume volume = std::move(measured_);
    if (volume.leaves.empty()) return;
    const voctree::VOctree still = clip_.still(frame);
    const ComparedViews compared(device_, still, parse_size(options_.size), options_.views);
    std::vector<interchange::FitView> views;
    for (size_t i = 0; i < compared.count(); i++)
        views.push_back({compared.camera_of(i), compared.render_still(still, i)});
    // Splats are fitted where leaves are larger than pixels: a shape that was fitted to whole images relies on how
    // renderers widen small splats, and lets through what is behind it when a viewer goes nearer.
    std::vector<interchange::FitView> close;
    for (const interchange::VolumeLeaf& leaf : interchange::typical_leaves(volume, kCloseViews)) {
        const stage::Camera camera =
            interchange::close_up(nearest_camera(compared, volume.centre_m(leaf)), volume, leaf);
        close.push_back({camera, compared.render_still(still, camera)});
    }
    fit_ = interchange::fit_shape(volume, close, [&] { working("comparing splats with images of the middle frame"); });
    psnr_ = interchange::psnr_of(interchange::splats_of(volume, fit_->shape), views);
}

void SplatExport::add(uint32_t frame, const Working&) {
    const interchange::SplatShape shape = fit_ ? fit_->shape : interchange::SplatShape{};
    waiting_.push_back(interchange::splats_of(volume_of(frame), shape, format_.rotation * clip_.rotation(frame)));
}

void SplatExport::write(const std::filesystem::path& file) {
    format_.write(file, waiting_, clip_.fps());
    for (const interchange::Splats& splats : waiting_) written_ += splats.splats.size();
    waiting_.clear();
}

void SplatExport::report(nlohmann::ordered_json& json) const {
    json["splats"] = written_;
    if (!fit_) return;
    json["psnr_db"] = psnr_;
    json["close_psnr_db"] = fit_->psnr;
    json["width"] = fit_->shape.width;
    json["density"] = fit_->shape.density;
}

std::string SplatExport::summary() const {
    if (!fit_) return fmt::format("{} splats", written_);
    return fmt::format("{} splats; images of the middle frame have {:.1f} dB, close-ups {:.1f} dB", written_, psnr_,
                       fit_->psnr);
}

}  // namespace

std::unique_ptr<FrameExport> export_splats(const ExportOptions& options, const std::string& ending, ExportedClip& clip,
                                           const CommonOptions& common) {
    for (const SplatFormat& format : kFormats)
        if (ending == format.ending) return std::make_unique<SplatExport>(options, format, clip, common);
    return nullptr;
}

}  // namespace neuvv::tools
