// Reads the deep files that the program writes, by OpenEXR's own reader.
#pragma once

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputFile.h>
#include <ImfHeader.h>

#include <filesystem>
#include <numeric>

#include "media/deep_exr.h"

namespace neuvv::test {

inline media::DeepImage read_deep(const std::filesystem::path& path) {
    Imf::DeepScanLineInputFile file(path.c_str());
    const auto window = file.header().dataWindow();
    media::DeepImage image;
    image.width = static_cast<uint32_t>(window.max.x - window.min.x + 1);
    image.height = static_cast<uint32_t>(window.max.y - window.min.y + 1);
    image.counts.resize(size_t{image.width} * image.height);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(image.counts.data()), 4, size_t{4} * image.width));
    const char* const names[] = {"Z", "ZBack", "R", "G", "B", "A"};
    std::vector<std::vector<float>> values(6);
    std::vector<std::vector<float*>> pixels(6);
    for (size_t c = 0; c < 6; ++c) {
        pixels[c].resize(image.counts.size());
        buffer.insert(names[c], Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pixels[c].data()), sizeof(float*),
                                               sizeof(float*) * image.width, sizeof(float)));
    }
    file.setFrameBuffer(buffer);
    file.readPixelSampleCounts(window.min.y, window.max.y);
    image.samples.resize(std::accumulate(image.counts.begin(), image.counts.end(), size_t{0}));
    for (size_t c = 0; c < 6; ++c) {
        values[c].resize(image.samples.size());
        float* at = values[c].data();
        for (size_t i = 0; i < image.counts.size(); at += image.counts[i++]) pixels[c][i] = at;
    }
    file.readPixels(window.min.y, window.max.y);
    for (size_t i = 0; i < image.samples.size(); ++i)
        image.samples[i] = {values[0][i], values[1][i], {values[2][i], values[3][i], values[4][i], values[5][i]}};
    return image;
}

}  // namespace neuvv::test
