#include "tools/export/export_run.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "tools/options.h"
#include "tools/results.h"
#include "tools/say.h"

namespace neuvv::tools {

void expect_room(const ExportOptions& options, const std::string& what, uint64_t bytes, const std::string& fix) {
    say("export: {} take about {}\n", what, size_text(bytes));
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::absolute(options.output).parent_path();
    const std::filesystem::space_info space = std::filesystem::space(folder, error);
    if (!error && space.available < bytes)
        throw InputError("--output", folder.string(), fmt::format("has {} left", size_text(space.available)), fix);
}

ExportRun::ExportRun(const ExportOptions& options, ExportedClip& clip, FrameExport& kind)
    : options_(options),
      clip_(clip),
      kind_(kind),
      numbered_(NumberedPath::parse_output("--output", options.output)),
      frames_(clip.frames_in(options.frames)) {
    expect_files_for_frames(std::filesystem::path(options.output).extension().string());
    prepare_output_file("--output", numbered_ ? numbered_->file(uint64_t{frames_.first}) : options.output);
    if (options.resume) return;  // it leaves those alone that are there
    for (uint32_t frame = frames_.first; frame <= frames_.last; ++frame)
        for (const std::filesystem::path& file :
             kind_.files_of(numbered_ ? numbered_->file(uint64_t{frame}) : options.output))
            prepare_result("--output", file);
}

void ExportRun::expect_files_for_frames(const std::string& ending) const {
    if (!numbered_ && !kind_.holds_many() && frames_.count() > 1)
        throw InputError("--output", options_.output, fmt::format("holds one frame, not {}", frames_.count()),
                         fmt::format("write out_%04d{}, or choose one with --frames", ending));
    if (options_.resume && !numbered_)
        throw InputError("--resume", options_.output, "is one file, which is written at once", "leave it out");
}

Working ExportRun::working(uint64_t done) {
    return [this, done](std::string_view what) {
        if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", options_.output));
        progress_.update(done, std::string(what));
    };
}

void ExportRun::write(const std::filesystem::path& file) {
    kind_.write(file);
    for (const std::filesystem::path& written : kind_.files_of(file)) {
        ++files_;
        bytes_ += std::filesystem::file_size(written);
    }
}

uint32_t ExportRun::measured_frame() const {
    const uint32_t centre = frames_.first + frames_.count() / 2;
    for (uint32_t away = 0; away < frames_.count(); ++away) {
        if (centre + away <= frames_.last && !clip_.is_hidden(centre + away)) return centre + away;
        if (centre >= frames_.first + away && !clip_.is_hidden(centre - away)) return centre - away;
    }
    return centre;
}

void ExportRun::run() {
    catch_stop_signals();
    progress_.set_total(frames_.count());
    const uint32_t centre = measured_frame();
    const FrameExport::Estimate each = kind_.estimate(centre);
    expect_room(options_, fmt::format("{} frames of {}", frames_.count(), each.what), each.bytes * frames_.count(),
                "choose fewer --frames, smaller ones, or another folder");
    kind_.measure(centre, working(0));
    bool waiting = false;  // frames that were added, but not written
    for (uint32_t frame = frames_.first; frame <= frames_.last; ++frame) {
        const Working at_work = working(frame - frames_.first);
        at_work("");
        const std::filesystem::path file = numbered_ ? numbered_->file(uint64_t{frame}) : options_.output;
        if (options_.resume && std::filesystem::exists(file)) continue;
        kind_.add(frame, at_work);
        waiting = !numbered_;
        if (numbered_) write(file);
    }
    if (waiting) write(options_.output);
    progress_.update(frames_.count());
    progress_.finish();
}

}  // namespace neuvv::tools
