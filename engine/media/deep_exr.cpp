#include "media/deep_exr.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfPartType.h>

#include <cassert>
#include <numeric>

#include "media/exr_memory.h"

namespace neuvv::media {

namespace {

// The values of a channel, sample after sample, and where those of each pixel begin.
template <typename T>
struct DeepChannel {
    std::vector<T> values;
    std::vector<const T*> pixels;

    DeepChannel(const DeepImage& image, const auto& value_of) {
        values.reserve(image.samples.size());
        for (const DeepSample& sample : image.samples) values.push_back(value_of(sample));
        const T* at = values.data();
        for (const uint32_t count : image.counts) {
            pixels.push_back(at);
            at += count;
        }
    }
    void add(const char* name, Imf::PixelType type, uint32_t width, Imf::Header& header,
             Imf::DeepFrameBuffer& to) const {
        header.channels().insert(name, Imf::Channel(type));
        auto* base = const_cast<char*>(reinterpret_cast<const char*>(pixels.data()));  // it is only read
        to.insert(name, Imf::DeepSlice(type, base, sizeof(T*), sizeof(T*) * width, sizeof(T)));
    }
};

std::vector<char> encode(const DeepImage& image) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    Imf::DeepFrameBuffer pixels;
    std::vector<uint32_t> counts = image.counts;
    pixels.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(uint32_t),
                                             sizeof(uint32_t) * image.width));
    const auto colour = [&](size_t c) {
        return DeepChannel<half>(image, [c](const DeepSample& sample) { return half_of(sample.rgba[c]); });
    };
    const DeepChannel<half> colours[] = {colour(0), colour(1), colour(2), colour(3)};
    const char* const names[] = {"R", "G", "B", "A"};
    for (size_t c = 0; c < 4; ++c) colours[c].add(names[c], Imf::HALF, image.width, header, pixels);
    const DeepChannel<float> near(image, [](const DeepSample& sample) { return sample.near_m; });
    const DeepChannel<float> far(image, [](const DeepSample& sample) { return sample.far_m; });
    near.add("Z", Imf::FLOAT, image.width, header, pixels);
    far.add("ZBack", Imf::FLOAT, image.width, header, pixels);
    return encoded([&](Imf::OStream& out) {
        Imf::DeepScanLineOutputFile file(out, header);
        file.setFrameBuffer(pixels);
        file.writePixels(static_cast<int>(image.height));
    });
}

}  // namespace

void write_deep_exr(const std::filesystem::path& file, const DeepImage& image) {
    assert(image.width > 0 && image.height > 0 && "an image to write has pixels");
    assert(image.counts.size() == size_t{image.width} * image.height && "a count a pixel");
    assert(std::accumulate(image.counts.begin(), image.counts.end(), size_t{0}) == image.samples.size());
    write_encoded(file, [&] { return encode(image); });
}

}  // namespace neuvv::media
