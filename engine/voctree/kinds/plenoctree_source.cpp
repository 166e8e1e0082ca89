#include "voctree/kinds/plenoctree_source.h"

#include <tuple>

namespace neuvv::voctree {

namespace {

class PlenoctreeSource : public ClipSource {
  public:
    explicit PlenoctreeSource(UpAxis up) : up_(up) {}
    FileStamp stamp(const ClipSegment& segment) const override { return neuvv::stamp_of(segment.file); }
    NvvHeader header(const ClipSegment& segment) const override {
        NvvHeader header{};
        std::tie(header.box_min, header.box_size) = read_plenoctree_box(segment.file, up_);
        header.frames = 1;
        header.leaf_count = 1;  // some
        header.fps = VOctree{}.fps;
        return header;
    }
    SegmentContent content(const ClipSegment& segment, stream::Part, PlenoctreeColours colours) const override {
        return read_plenoctree(segment.file, colours, up_);
    }
    Box box(const ClipSegment& segment) const override {
        const auto [low, high] = read_plenoctree_leaf_box(segment.file, up_);
        return {low, high, true};
    }

  private:
    UpAxis up_;
};

}  // namespace

ClipIndex index_of_plenoctree(const std::filesystem::path& path, UpAxis up) {
    read_plenoctree_box(path, up);  // which throws where the file is damaged
    return {VOctree{}.fps, {{path, 0, 1, 0, std::make_shared<const PlenoctreeSource>(up)}}};
}

}  // namespace neuvv::voctree
