// Stages for programs that know no clips: splats stand in for performers.
#include "interchange/stand_ins.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/output_path.h"
#include "stage/evaluated_stage.h"
#include "tools/export/splat_fit.h"
#include "tools/export/stage_kinds.h"
#include "tools/report.h"

namespace neuvv::tools {

namespace {

constexpr uint32_t kMostSplats = 50000;  // of a performer, where the user says nothing

// The stand-ins of a stage's performers at a time. Performers that show the same share their splats, and those of one
// clip with the same paint share the shape of splats.
class StandIns {
  public:
    StandIns(const ExportOptions& options, const CommonOptions& common, const stage::Stage& stage)
        : options_(options), device_(common.device), stage_(stage) {
        if (options_.size.empty()) options_.size = kFrameSize;
        progress_.set_total(stage.performers.size());
    }

    void add(const stage::EvaluatedPerformer& shown);
    void finish() { progress_.finish(); }
    const std::vector<interchange::Splats>& splats() const { return splats_; }
    const std::vector<interchange::StandIn>& all() const { return stand_ins_; }
    const nlohmann::ordered_json& report() const { return report_; }

  private:
    interchange::Splats splats_of(const stage::StagePerformer& performer, uint32_t frame, const std::string& look);

    ExportOptions options_;
    gpu::Device device_;
    const stage::Stage& stage_;
    std::map<std::string, std::optional<FittedSplats>> fits_;  // by clip and paint
    // The index into splats_ by clip, paint, frame and opacity; none where the frame is empty.
    std::map<std::string, std::optional<size_t>> known_;
    std::vector<interchange::Splats> splats_;
    std::vector<interchange::StandIn> stand_ins_;
    nlohmann::ordered_json report_ = nlohmann::ordered_json::array();
    Progress progress_{"export"};
    uint64_t done_ = 0;
};

interchange::Splats StandIns::splats_of(const stage::StagePerformer& performer, uint32_t frame,
                                        const std::string& look) {
    const auto working = [&](std::string_view what) {
        if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", options_.output));
        progress_.update(done_, fmt::format("{}: {}", performer.name, what));
    };
    working("reading");
    ExportedClip clip(read_published_scene(options_.scene, std::to_string(performer.node), options_.up), std::nullopt,
                      false);
    const interchange::FrameVolume volume = splat_volume(clip, frame, options_.most_splats.value_or(kMostSplats));
    const bool is_known = fits_.contains(look);
    if (!is_known) fits_[look] = fit_splats(device_, options_, clip, frame, volume, working);
    const std::optional<FittedSplats>& fit = fits_[look];
    if (fit && !is_known) report_.back().update({{"psnr_db", fit->psnr}, {"close_psnr_db", fit->close_psnr}});
    return interchange::splats_of(volume, fit ? fit->shape : interchange::SplatShape{});
}

void StandIns::add(const stage::EvaluatedPerformer& shown) {
    const stage::StagePerformer& performer = stage_.performers[shown.performer];
    if (!shown.visible || shown.opacity <= 0) return;
    const auto frame = static_cast<uint32_t>(std::lround(shown.frame));
    nlohmann::ordered_json paint = nlohmann::ordered_json::array();
    for (const stage::PaintLayer& layer : performer.settings.paint) paint.push_back(stage::json_of(layer));
    const std::string look = fmt::format("{} {}", shown.clip, paint.dump());
    const std::string key = fmt::format("{} {} {}", look, frame, shown.opacity);
    report_.push_back({{"performer", performer.name}, {"frame", frame}});
    if (!known_.contains(key)) {
        interchange::Splats splats = splats_of(performer, frame, look);
        for (interchange::Splat& splat : splats.splats) splat.opacity *= shown.opacity;
        if (!splats.splats.empty()) {
            known_[key] = splats_.size();
            splats_.push_back(std::move(splats));
        } else {
            known_[key] = std::nullopt;
        }
    }
    done_++;
    const std::optional<size_t> splats = known_[key];
    report_.back()["splats"] = splats ? splats_[*splats].splats.size() : 0;
    if (!splats) return;
    const double turn_rad = glm::radians(std::fmod(performer.settings.spin_deg_per_s * options_.time_s, 360));
    stand_ins_.push_back({performer.node, *splats, glm::angleAxis(turn_rad, glm::dvec3(0, 1, 0))});
}

}  // namespace

std::string write_stage_with_splats(const ExportOptions& options, const CommonOptions& common,
                                    nlohmann::ordered_json& json) {
    const stage::Stage stage = stage::load_stage(options.scene);
    if (interchange::has_stand_ins(stage.file))
        throw InputError("scene", options.scene, "has stand-ins already", "give the stage from which it was made");
    prepare_output_file("--output", options.output);
    catch_stop_signals();
    StandIns stand_ins(options, common, stage);
    for (const stage::EvaluatedPerformer& performer : stage::stage_at(stage, options.time_s).performers)
        stand_ins.add(performer);
    stand_ins.finish();
    interchange::write_stand_ins(options.output, stage.file, stand_ins.splats(), stand_ins.all());
    json["performers"] = stand_ins.report();
    size_t splats = 0;
    for (const interchange::Splats& written : stand_ins.splats()) splats += written.splats.size();
    return fmt::format("{} splats for {} of {} performers", splats, stand_ins.all().size(), stage.performers.size());
}

}  // namespace neuvv::tools
