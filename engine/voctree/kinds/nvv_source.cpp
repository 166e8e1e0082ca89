#include "voctree/kinds/nvv_source.h"

#include <fmt/format.h>

#include "base/error.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::voctree {

namespace {

void require_frames(const ClipSegment& segment, uint32_t frames) {
    if (frames != segment.frames_of_file())
        throw InputError(segment.file.string(), "HEAD",
                         fmt::format("has {} frames, its clip says {}", frames, segment.frames_of_file()),
                         "train the segment again");
}

class NvvSource : public ClipSource {
  public:
    FileStamp stamp(const ClipSegment& segment) const override { return neuvv::stamp_of(segment.file); }
    NvvHeader header(const ClipSegment& segment) const override {
        const NvvHeader header = summarise_nvv(segment.file).header;
        require_frames(segment, header.frames);
        return header;
    }
    SegmentContent content(const ClipSegment& segment, stream::Part, PlenoctreeColours) const override {
        return read_whole(segment);
    }
    std::optional<VOctree> coarse(const ClipSegment& segment) const override {
        try {
            std::optional<VOctree> tree = read_nvv_coarse(segment.file);
            if (tree && tree->frames == segment.frames_of_file()) return tree;
        } catch (const InputError&) {
        }
        return {};
    }
    Box box(const ClipSegment& segment) const override {
        std::optional<VOctree> tree = read_nvv_coarse(segment.file);
        if (!tree) tree = read_whole(segment);
        const auto [low, high] = occupied_box(*tree);
        return {low, high, tree->leaf_count > 0};
    }

  private:
    static VOctree read_whole(const ClipSegment& segment) {
        VOctree tree = read_nvv(segment.file);
        require_frames(segment, tree.frames);
        return tree;
    }
};

}  // namespace

std::shared_ptr<const ClipSource> nvv_source() {
    static const auto kSource = std::make_shared<const NvvSource>();
    return kSource;
}

ClipIndex index_of_nvv(const std::filesystem::path& path) {
    const NvvHeader header = summarise_nvv(path).header;
    return {header.fps, {{path, 0, header.frames, 0, nvv_source()}}};
}

}  // namespace neuvv::voctree
