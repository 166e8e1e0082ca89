// A run of `neuvv export`: the frames and files that are asked for, room on the disk, progress, and the way to stop.
#pragma once

#include <optional>

#include "base/numbered_path.h"
#include "tools/export/exported_clip.h"
#include "tools/export/frame_export.h"
#include "tools/report.h"

namespace neuvv::tools {

// Says how much disk `what` takes: "25 frames of about 20000 splats". Throws InputError, which advises `fix`, where
// there is less left.
void expect_room(const ExportOptions& options, const std::string& what, uint64_t bytes, const std::string& fix);

class ExportRun {
  public:
    // Throws InputError where frames and output do not fit together. All of them must outlive it.
    ExportRun(const ExportOptions& options, ExportedClip& clip, FrameExport& kind);

    // Throws RuntimeFailure where the user stops it, and where a file cannot be written.
    void run();
    uint64_t files() const { return files_; }  // those that were there already do not count
    uint64_t bytes() const { return bytes_; }

  private:
    void expect_files_for_frames(const std::string& ending) const;
    uint32_t measured_frame() const;  // the one nearest to the centre in which the performer is not hidden
    void write(const std::filesystem::path& file);
    Working working(uint64_t done);

    const ExportOptions& options_;
    const ExportedClip& clip_;
    FrameExport& kind_;
    std::optional<NumberedPath> numbered_;
    ExportedClip::Frames frames_;
    uint64_t files_ = 0, bytes_ = 0;
    Progress progress_{"export"};
};

}  // namespace neuvv::tools
