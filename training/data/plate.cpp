#include "training/data/plate.h"

#include <algorithm>
#include <cassert>

#include "base/threads/parallel.h"

namespace neuvv::training {

media::Image median_background(const std::vector<media::Image>& frames) {
    assert(!frames.empty() && "a median is of something");
    media::Image median(frames[0].width, frames[0].height);
    for (const media::Image& frame : frames) {
        assert(frame.rgba.size() == median.rgba.size() && "frames of one camera have one size");
        (void)frame;
    }
    parallel_for(median.rgba.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
        std::vector<uint8_t> values(frames.size());
        for (size_t i = begin; i < end; ++i) {
            for (size_t f = 0; f < frames.size(); ++f) values[f] = frames[f].rgba[i];
            const auto centre = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
            std::nth_element(values.begin(), centre, values.end());
            median.rgba[i] = i % 4 == 3 ? 255 : *centre;
        }
    });
    return median;
}

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
