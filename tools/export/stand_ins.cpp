// Stages for programs that know no clips: splats stand in for performers.
#include "interchange/stage/stand_ins.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/output_path.h"
#include "interchange/splats/splat_gltf.h"
#include "stage/evaluated_stage.h"
#include "tools/export/export_run.h"
#include "tools/export/splat_fit.h"
#include "tools/export/stage_kinds.h"
#include "tools/results.h"
#include "tools/stage/stage_verbs.h"

namespace neuvv::tools {

namespace {

constexpr uint32_t kMostSplats = 50000;  // of a performer, where the user says nothing

// The stand-ins of a stage's performers at a time. Performers that show the same share their splats, and those of one
// clip with the same paint share the shape of splats.
class StandIns {
  public:
    StandIns(const ExportOptions& options, const CommonOptions& common, std::shared_ptr<const stage::Stage> stage);

    // Reads the frames that the stage shows at its time. Throws InputError where no performer is to be seen.
    void read();
    // Makes splats of them, with progress.
    void shape();
    void write() const { interchange::write_stand_ins(options_.output, *stage_, splats_, stand_ins_); }
    void report(nlohmann::ordered_json& json) const;
    std::string summary() const;

  private:
    struct Shown {
        std::string look;  // the clip and its paint
        uint32_t frame = 0;
        float opacity = 1;
        slice::Slice volume{};
    };
    void read(const stage::EvaluatedPerformer& performer, Progress& progress);
    void expect_no_stop() const;  // throws RuntimeFailure where the user wants to stop

    ExportOptions options_;
    gpu::Device device_;
    const std::shared_ptr<const stage::Stage> stage_;
    std::vector<Shown> shown_;
    std::vector<std::string> left_out_;               // why performers have no stand-in
    std::map<std::string, voctree::VOctree> stills_;  // by look: the frame by which splats get their shape
    std::map<std::string, FittedSplats> fits_;
    std::vector<interchange::Splats> splats_;  // one for each of shown_
    std::vector<interchange::StandIn> stand_ins_;
};

StandIns::StandIns(const ExportOptions& options, const CommonOptions& common, std::shared_ptr<const stage::Stage> stage)
    : options_(options), device_(common.device), stage_(std::move(stage)) {
    if (options_.size.empty()) options_.size = kFrameSize;
}

void StandIns::expect_no_stop() const {
    if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", options_.output));
}

void StandIns::read() {
    Progress progress("read", stage_->performers.size());
    expect_time_on_stage(*stage_, "--time", options_.time_s);
    for (const stage::EvaluatedPerformer& performer : stage::stage_at(*stage_, options_.time_s).performers)
        read(performer, progress);
    if (stand_ins_.empty()) {
        const std::string problem = fmt::format("shows no performer at {} s", options_.time_s);
        if (left_out_.empty()) throw InputError("scene", options_.scene, problem, "add one by neuvv stage add");
        throw InputError("scene", options_.scene, fmt::format("{}: {}", problem, fmt::join(left_out_, ", ")),
                         "show one by neuvv stage set, or choose another --time");
    }
    progress.update(stage_->performers.size());
    progress.finish();
    uint64_t bytes = stage_->file.saved->bytes.size();
    size_t splats = 0;
    for (const Shown& shown : shown_) {
        splats += shown.volume.leaves.size();
        bytes += shown.volume.leaves.size() * interchange::glb_bytes_of_splat(shown.volume.degree);
    }
    expect_room(options_, fmt::format("{} splats", splats), bytes, "choose a lower --most-splats, or another folder");
}

void StandIns::read(const stage::EvaluatedPerformer& evaluated, Progress& progress) {
    const stage::StagePerformer& performer = stage_->performers[evaluated.performer];
    if (!evaluated.visible || evaluated.opacity <= 0) {
        left_out_.push_back(performer.name + " is hidden");
        return;
    }
    nlohmann::ordered_json paint = nlohmann::ordered_json::array();
    for (const stage::PaintLayer& layer : performer.settings.paint) paint.push_back(stage::json_of(layer));
    Shown shown{fmt::format("{} {}", evaluated.clip, paint.dump()), static_cast<uint32_t>(std::lround(evaluated.frame)),
                evaluated.opacity};
    const auto known = std::find_if(shown_.begin(), shown_.end(), [&](const Shown& other) {
        return other.look == shown.look && other.frame == shown.frame && other.opacity == shown.opacity;
    });
    const double turn_rad = glm::radians(std::fmod(performer.settings.spin_deg_per_s * options_.time_s, 360));
    const interchange::StandIn stand_in{performer.node, static_cast<size_t>(known - shown_.begin()),
                                        glm::angleAxis(turn_rad, glm::dvec3(0, 1, 0))};
    if (known == shown_.end()) {
        expect_no_stop();
        progress.update(evaluated.performer, performer.name);
        ExportedClip clip(published_performer(stage_, evaluated.performer), std::nullopt, false);
        shown.volume = splat_volume(clip, shown.frame, options_.most_splats.value_or(kMostSplats));
        if (shown.volume.leaves.empty()) {
            left_out_.push_back(performer.name + " is empty");
            return;
        }
        if (!stills_.contains(shown.look)) stills_[shown.look] = clip.still(shown.frame);
        shown_.push_back(std::move(shown));
    }
    stand_ins_.push_back(stand_in);
}

void StandIns::shape() {
    Progress progress("export", shown_.size());
    for (const Shown& shown : shown_) {
        const Working working = [&](std::string_view what) {
            expect_no_stop();
            progress.update(splats_.size(), std::string(what));
        };
        working("");
        if (!fits_.contains(shown.look))
            fits_[shown.look] = fit_splats(device_, options_, stills_.at(shown.look), shown.volume, working).value();
        splats_.push_back(interchange::splats_of(shown.volume, fits_[shown.look].shape));
        for (interchange::Splat& splat : splats_.back().splats) splat.opacity *= shown.opacity;
    }
    progress.update(shown_.size());
}

void StandIns::report(nlohmann::ordered_json& json) const {
    json["performers"] = nlohmann::ordered_json::array();
    for (const interchange::StandIn& stand_in : stand_ins_) {
        const Shown& shown = shown_[stand_in.splats];
        const FittedSplats& fit = fits_.at(shown.look);
        json["performers"].push_back({{"performer", stage::node_title(stage_->scene, stand_in.node)},
                                      {"frame", shown.frame},
                                      {"splats", splats_[stand_in.splats].splats.size()},
                                      {"psnr_db", fit.psnr},
                                      {"close_psnr_db", fit.close_psnr}});
    }
}

std::string StandIns::summary() const {
    size_t splats = 0;
    for (const interchange::Splats& written : splats_) splats += written.splats.size();
    const auto worst = std::min_element(fits_.begin(), fits_.end(),
                                        [](const auto& a, const auto& b) { return a.second.psnr < b.second.psnr; });
    std::string text =
        fmt::format("{} splats for {} of {} performers; the worst images have {:.1f} dB, their close-ups {:.1f} dB",
                    splats, stand_ins_.size(), stage_->performers.size(), worst->second.psnr, worst->second.close_psnr);
    for (const std::string& why : left_out_) text += "; " + why;
    return text;
}

}  // namespace

std::string write_stage_with_splats(const ExportOptions& options, const CommonOptions& common,
                                    nlohmann::ordered_json& json) {
    const auto stage = std::make_shared<const stage::Stage>(stage::load_stage(options.scene));
    if (interchange::has_stand_ins(*stage))
        throw InputError("scene", options.scene, "has stand-ins already", "give the stage from which it was made");
    prepare_result("--output", options.output);
    catch_stop_signals();
    StandIns stand_ins(options, common, stage);
    stand_ins.read();
    stand_ins.shape();
    stand_ins.write();
    stand_ins.report(json);
    return stand_ins.summary();
}

}  // namespace neuvv::tools
