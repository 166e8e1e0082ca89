// A frame of a clip as splats that look like it: which leaves become splats, and the shape of these.
#pragma once

#include <optional>

#include "gpu/device.h"
#include "interchange/splats/splats.h"
#include "tools/export/exported_clip.h"
#include "tools/export/frame_export.h"

namespace neuvv::tools {

// The leaves of a frame, merged to at most `most` where that is not 0.
slice::Slice splat_volume(ExportedClip& clip, uint32_t frame, uint32_t most);

struct FittedSplats {
    interchange::SplatShape shape;
    double psnr = 0;        // dB, of options.views images of the frame, which the splats were not fitted to
    double close_psnr = 0;  // dB, of the close-ups that they were fitted to
};

// The shape of splats whose images are most like those of a frame, as a tree and as the leaves that become splats;
// nothing where there are none. `working` is told what is being done, and may throw.
std::optional<FittedSplats> fit_splats(const gpu::Device& device, const ExportOptions& options,
                                       const voctree::VOctree& still, const slice::Slice& volume,
                                       const Working& working);

}  // namespace neuvv::tools
