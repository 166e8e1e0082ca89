#include "training/image_reader.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::training {

namespace {

constexpr uint64_t kMaxImageFileBytes = uint64_t{1} << 30;

}  // namespace

media::Image ImageReader::read(const ImageSource& source) {
    if (source.video_frame < 0) {
        const std::vector<uint8_t> bytes = read_file(source.path, kMaxImageFileBytes);
        return media::decode_image(bytes.data(), bytes.size(), source.path.string());
    }
    if (!video_ || path_ != source.path || source.video_frame < next_frame_) {
        video_.emplace(source.path);
        path_ = source.path;
        next_frame_ = 0;
    }
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
    return source.video_frame < 0 ? media::image_size(source.path) : media::VideoReader(source.path).size();
}

}  // namespace neuvv::training
