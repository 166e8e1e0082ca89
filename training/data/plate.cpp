#include "training/data/plate.h"

#include <algorithm>

#include "training/data/matte.h"

namespace neuvv::training {

media::Image read_plate(const ImageSource& source, const ImageReader::ExpectSize& expect_size) {
    ImageReader reader;
    if (source.video_frame < 0) return reader.read(source, expect_size);
    const int64_t frames = media::VideoReader(source.path).frames();
    const int64_t count = std::clamp<int64_t>(frames, 1, kMaxMedianFrames);
    std::vector<media::Image> some;
    for (int64_t i = 0; i < count; ++i)
        some.push_back(reader.read({source.path, count > 1 ? i * (frames - 1) / (count - 1) : 0}, expect_size));
    return median_background(some);
}

}  // namespace neuvv::training
