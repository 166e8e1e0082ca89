#include "training/data/layouts/rig/image_reader.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/platform.h"
#include "media/orientation.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxImageFileBytes = uint64_t{1} << 30;

media::ImageHeader as_used(media::ImageHeader header, const ImageSource& source) {
    if (source.as_stored) header.orientation = media::Orientation::kUpright;
    return header;
}

}  // namespace

media::Image ImageReader::read(const ImageSource& source, const ExpectSize& expect_size) {
    if (source.video_frame < 0) {
        const std::vector<uint8_t> bytes = read_file(source.path, kMaxImageFileBytes);
        const std::string name = source.path.string();
        const media::ImageHeader header = as_used(media::image_header(bytes.data(), bytes.size(), name), source);
        if (expect_size)
            expect_size(media::shown_size(header.stored, header.orientation));
        else
            media::expect_content(header.stored, bytes.size(), name);
        return media::shown(media::decode_image(bytes.data(), bytes.size(), name), header.orientation);
    }
    if (!video_ || path_ != source.path || source.video_frame < next_frame_) {
        video_.emplace(source.path);
        path_ = source.path;
        next_frame_ = 0;
    }
    if (expect_size) expect_size(video_->size());
    const auto expect = [&](bool there) {
        if (!there)
            throw InputError(source.path.string(), fmt::format("frame {}", source.video_frame),
                             fmt::format("is past the video's end: it has {} frames", next_frame_),
                             "make the videos of all cameras equally long");
    };
    for (; next_frame_ < source.video_frame; ++next_frame_) expect(video_->skip());
    media::Image image;
    expect(video_->next(image));
    ++next_frame_;
    return image;
}

media::ImageSize size_of(const ImageSource& source) {
    if (source.video_frame >= 0) return media::VideoReader(source.path).size();
    const media::ImageHeader header = as_used(media::image_header(source.path), source);
    media::expect_content(header.stored, std::filesystem::file_size(source.path), source.path.string());
    return media::shown_size(header.stored, header.orientation);
}

}  // namespace neuvv::training
