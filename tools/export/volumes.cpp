// Frames as OpenVDB files.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.h"
#include "interchange/volume/vdb_volume.h"
#include "interchange/volume/vdb_writer.h"
#include "media/psnr.h"
#include "tools/compared_views.h"
#include "tools/export/exported_clip.h"
#include "tools/export/frame_export.h"
#include "tools/options.h"
#include "voctree/coarse.h"

namespace neuvv::tools {

namespace {

class VolumeExport : public FrameExport {
  public:
    VolumeExport(const ExportOptions& options, ExportedClip& clip, const CommonOptions& common)
        : options_(options), clip_(clip), device_(common.device) {}

    bool holds_many() const override { return false; }
    Estimate estimate(uint32_t frame) override;
    void measure(uint32_t frame, const Working& working) override;
    void add(uint32_t frame, const Working&) override {
        waiting_ = slice::scaled(volume_of(frame), clip_.capture().unit);
        vdb_.rotation = clip_.rotation(frame);
        vdb_.origin = clip_.capture().origin;
    }
    void write(const std::filesystem::path& file) override;
    void report(nlohmann::ordered_json& json) const override;
    std::string summary() const override;

  private:
    slice::Slice volume_of(uint32_t frame);

    const ExportOptions& options_;
    ExportedClip& clip_;
    gpu::Device device_;
    slice::Slice waiting_;  // to be written
    interchange::VdbOptions vdb_;
    uint64_t written_ = 0;  // leaves
    double edge_m_ = 0;     // of voxels
    std::optional<double> psnr_;
};

slice::Slice VolumeExport::volume_of(uint32_t frame) {
    // Voxels have one size in all frames of a segment.
    vdb_.depth = clip_.finest_depth(frame);
    if (options_.iso) vdb_.surface_opacity = static_cast<float>(*options_.iso);
    return clip_.slice_of(frame);
}

FrameExport::Estimate VolumeExport::estimate(uint32_t frame) {
    waiting_ = volume_of(frame);
    if (options_.iso && !interchange::has_cubic_cells(waiting_))
        throw InputError("--iso", "", "needs a clip whose cells are cubes", "leave it out");
    edge_m_ = double{waiting_.box_size.x} / (1u << vdb_.depth);
    const size_t leaves = waiting_.leaves.size();
    return {leaves * interchange::kVdbBytesOfLeaf, fmt::format("about {} leaves", leaves)};
}

// Renderers interpolate between voxels, and know no colour by direction: what that changes.
void VolumeExport::measure(uint32_t frame, const Working& working) {
    if (waiting_.leaves.empty()) return;
    working("comparing the volume with images of the middle frame");
    const std::string bytes = interchange::vdb_bytes(waiting_, {vdb_.depth});
    const interchange::VdbVolume read = interchange::volume_of(
        interchange::parse_vdb({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}, options_.output).grids,
        options_.output, glm::dmat4(1));
    const voctree::VOctree still = clip_.still(frame);
    const ComparedViews views(device_, still, parse_size(options_.size), options_.views);
    std::vector<double> psnrs;
    for (size_t i = 0; i < views.count(); ++i) {
        const media::Image drawn = interchange::vdb_image(
            read, views.camera_of(i), [&] { working("comparing the volume with images of the middle frame"); });
        psnrs.push_back(media::psnr_db(views.render_still(still, i), drawn));
    }
    psnr_ = psnr_together(psnrs);
}

void VolumeExport::write(const std::filesystem::path& file) {
    interchange::write_vdb(file, waiting_, vdb_);
    written_ += waiting_.leaves.size();
}

void VolumeExport::report(nlohmann::ordered_json& json) const {
    json["leaves"] = written_;
    json["voxel_m"] = edge_m_;
    if (psnr_) json["psnr_db"] = *psnr_;
}

std::string VolumeExport::summary() const {
    const std::string text = fmt::format("{} leaves, voxels of {:.1f} mm", written_, 1000 * edge_m_);
    return psnr_ ? fmt::format("{}; images of the middle frame have {:.1f} dB", text, *psnr_) : text;
}

}  // namespace

std::unique_ptr<FrameExport> export_volumes(const ExportOptions& options, const std::string&, ExportedClip& clip,
                                            const CommonOptions& common) {
    return std::make_unique<VolumeExport>(options, clip, common);
}

}  // namespace neuvv::tools
