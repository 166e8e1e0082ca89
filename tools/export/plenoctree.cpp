// Frames as PlenOctrees: .npz of svox and volrend.
#include "interchange/volume/plenoctree_npz.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.h"
#include "media/psnr.h"
#include "tools/compared_views.h"
#include "tools/export/exported_clip.h"
#include "tools/export/frame_export.h"
#include "tools/options.h"
#include "voctree/files/plenoctree.h"

namespace neuvv::tools {

namespace {

constexpr double kLeastTurn = 1e-9;  // 1 − cos of half the angle

class PlenoctreeExport : public FrameExport {
  public:
    PlenoctreeExport(const ExportOptions& options, ExportedClip& clip, const CommonOptions& common)
        : options_(options), clip_(clip), device_(common.device) {}

    bool holds_many() const override { return false; }
    Estimate estimate(uint32_t frame) override;
    void measure(uint32_t frame, const Working& working) override;
    void add(uint32_t frame, const Working& working) override;
    void write(const std::filesystem::path& file) override;
    void report(nlohmann::ordered_json& json) const override;
    std::string summary() const override;

  private:
    const ExportOptions& options_;
    ExportedClip& clip_;
    gpu::Device device_;
    std::optional<ComparedViews> compared_;  // with the images of the measured frame
    std::vector<media::Image> truth_;
    uint32_t measured_ = 0, waiting_frame_ = 0;
    slice::Slice waiting_;
    uint64_t leaves_ = 0;
    std::optional<double> psnr_;  // of the measured frame, once it is written
};

FrameExport::Estimate PlenoctreeExport::estimate(uint32_t frame) {
    const slice::Slice volume = clip_.slice_of(frame);
    return {interchange::plenoctree_bytes(volume), fmt::format("about {} leaves", volume.leaves.size())};
}

void PlenoctreeExport::measure(uint32_t frame, const Working& working) {
    if (clip_.slice_of(frame).leaves.empty()) return;
    measured_ = frame;
    const voctree::VOctree still = clip_.still(frame);
    compared_.emplace(device_, still, parse_size(options_.size), options_.views);
    for (size_t i = 0; i < compared_->count(); ++i) {
        working("images of the middle frame");
        truth_.push_back(compared_->render_still(still, i));
    }
}

void PlenoctreeExport::add(uint32_t frame, const Working&) {
    // The cells of a PlenOctree are along the axes.
    if (std::abs(clip_.rotation(frame).w) < 1 - kLeastTurn)
        throw InputError("--stage-space", fmt::format("frame {}", frame),
                         "has the performer turned, which no PlenOctree can be", "choose another kind of --as");
    waiting_ = clip_.slice_of(frame);
    waiting_frame_ = frame;
}

// What is lost is measured on the file.
void PlenoctreeExport::write(const std::filesystem::path& file) {
    interchange::write_plenoctree(file, waiting_);
    leaves_ += waiting_.leaves.size();
    if (!compared_ || waiting_frame_ != measured_) return;
    const voctree::VOctree read = voctree::read_plenoctree(file, voctree::PlenoctreeColours::kAsStored);
    std::vector<double> psnrs;
    for (size_t i = 0; i < truth_.size(); ++i)
        psnrs.push_back(media::psnr_db(truth_[i], compared_->render_still(read, i)));
    psnr_ = psnr_together(psnrs);
}

void PlenoctreeExport::report(nlohmann::ordered_json& json) const {
    json["leaves"] = leaves_;
    if (psnr_) json["psnr_db"] = *psnr_;
}

std::string PlenoctreeExport::summary() const {
    const voctree::WorldFrame& capture = clip_.capture();
    std::string text = origin_text(capture);
    if (capture.unit != 1) text += fmt::format("; its unit is {:.6g} of the capture's", capture.unit);
    if (!psnr_) return fmt::format("{} leaves{}", leaves_, text);
    return fmt::format("{} leaves; images of the middle frame have {:.1f} dB{}", leaves_, *psnr_, text);
}

}  // namespace

std::unique_ptr<FrameExport> export_plenoctree(const ExportOptions& options, const std::string&, ExportedClip& clip,
                                               const CommonOptions& common) {
    return std::make_unique<PlenoctreeExport>(options, clip, common);
}

}  // namespace neuvv::tools
