// Deep files, read back by OpenEXR's own reader.
#include "media/deep_exr.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputFile.h>
#include <ImfHeader.h>
#include <gtest/gtest.h>

#include "support/read_deep.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

TEST(DeepExr, SamplesAreReadBack) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path / "deep.exr";
    media::DeepImage image{3, 2, {0, 2, 1, 0, 0, 1}, {}};
    image.samples = {{1.2345678f, 1.5f, {0.25f, 0.125f, 0.5f, 0.75f}},
                     {2, 2, {1e9f, -1, 0, 1}},
                     {3, 3.25f, {0.1f, 0.2f, 0.3f, 0.4f}},
                     {4, 5, {0, 0, 0, 0.001f}}};
    media::write_deep_exr(file, image);
    EXPECT_EQ(folder.entries(), 1u);
    const media::DeepImage back = test::read_deep(file);
    EXPECT_EQ(back.width, 3u);
    EXPECT_EQ(back.counts, image.counts);
    ASSERT_EQ(back.samples.size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(back.samples[i].near_m, image.samples[i].near_m) << i;
        EXPECT_EQ(back.samples[i].far_m, image.samples[i].far_m) << i;
        for (size_t c = 0; c < 4; ++c) {
            const float expected = std::min(image.samples[i].rgba[c], 65504.0f);
            EXPECT_NEAR(back.samples[i].rgba[c], expected, std::abs(expected) / 2048 + 1e-7f) << i;
        }
    }
    const Imf::DeepScanLineInputFile in(file.c_str());
    EXPECT_EQ(in.header().channels().findChannel("A")->type, Imf::HALF);
    EXPECT_EQ(in.header().channels().findChannel("ZBack")->type, Imf::FLOAT);
    media::write_deep_exr(folder.path / "empty.exr", {2, 1, {0, 0}, {}});
    EXPECT_TRUE(test::read_deep(folder.path / "empty.exr").samples.empty());
}

}  // namespace
}  // namespace neuvv
