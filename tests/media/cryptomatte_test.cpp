// Identifiers against MurmurHash3's own test vectors and names of Cryptomatte's sample images.
#include "media/cryptomatte.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "media/exr.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

TEST(Cryptomatte, IdentifiersAreMurmurHashes) {
    const auto bits = [](const char* name) { return std::bit_cast<uint32_t>(media::id_of_name(name)); };
    EXPECT_EQ(bits("hello"), 0x248bfa47u);
    EXPECT_EQ(bits("hello, world"), 0x149bbb7fu);
    EXPECT_EQ(bits("The quick brown fox jumps over the lazy dog."), 0xd5c48bfcu);
    EXPECT_EQ(bits(""), 1u << 23) << "a hash of 0 would be no name, and is moved from where floats are denormal";
    // Of Psyop's sample image, and of the one that Gaffer's tests have.
    EXPECT_NEAR(media::id_of_name("bunny") * 1e27, 3.36000126251, 1e-6);
    EXPECT_NEAR(media::id_of_name("/GAFFERBOT/C_torso_GRP/C_head_GRP/C_head_CPT/C_head001_REN") * 1e-36,
                -2.5222249091461295, 1e-6);
    for (int i = 0; i < 4000; ++i) {
        const float id = media::id_of_name("name " + std::to_string(i));
        EXPECT_TRUE(std::isnormal(id)) << i;
    }
}

std::string text_of(const Imf::Header& header, const char* key) {
    const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(key);
    return attribute ? attribute->value() : "missing";
}

// What a compositing program does: finds the manifest, and adds up the coverage of a name in all ranks.
TEST(Cryptomatte, MattesAreReadByName) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path / "ids.exr";
    media::LinearImage image{3, 2, std::vector<float>(24, 0.5f)};
    image.ids.names = {"anna", "Bärbel \"x\"", "set"};
    image.ids.pixels.resize(6);
    image.ids.pixels[1] = {{{1, 0.75f}, {0, 0.25f}}};
    image.ids.pixels[4] = {{{2, 0.5f}, {0, 0.3f}, {1, 0.125f}}};
    media::write_exr(file, image);
    EXPECT_EQ(media::read_exr(file).rgba, image.rgba);
    Imf::InputFile in(file.c_str());
    const std::string prefix = "cryptomatte/3ae39a5/";  // the hash of the layer's name, without its last digit
    EXPECT_EQ(text_of(in.header(), (prefix + "name").c_str()), "CryptoObject");
    EXPECT_EQ(text_of(in.header(), (prefix + "hash").c_str()), "MurmurHash3_32");
    EXPECT_EQ(text_of(in.header(), (prefix + "conversion").c_str()), "uint32_to_float32");
    const auto manifest = nlohmann::json::parse(text_of(in.header(), (prefix + "manifest").c_str()));
    ASSERT_EQ(manifest.size(), 3u);
    std::vector<std::vector<float>> planes;
    for (const std::string& channel : media::id_channels()) {
        ASSERT_TRUE(in.header().channels().findChannel(channel)) << channel;
        EXPECT_EQ(in.header().channels().findChannel(channel)->type, Imf::FLOAT);
        std::vector<float>& plane = planes.emplace_back(6);
        Imf::FrameBuffer buffer;
        buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()), 4, 12));
        in.setFrameBuffer(buffer);
        in.readPixels(0, 1);
    }
    ASSERT_EQ(planes.size(), 12u);
    const auto matte = [&](const std::string& name, size_t pixel) {
        const auto id =
            std::bit_cast<float>(static_cast<uint32_t>(std::stoul(manifest.at(name).get<std::string>(), nullptr, 16)));
        float sum = 0;
        for (size_t rank = 0; rank < 6; ++rank)
            if (planes[2 * rank][pixel] == id) sum += planes[2 * rank + 1][pixel];
        return sum;
    };
    EXPECT_EQ(matte("anna", 1), 0.25f);
    EXPECT_EQ(matte("Bärbel \"x\"", 1), 0.75f);
    EXPECT_EQ(matte("set", 1), 0);
    EXPECT_EQ(matte("anna", 4), 0.3f);
    EXPECT_EQ(matte("set", 4), 0.5f);
    EXPECT_EQ(matte("anna", 0), 0);
}

}  // namespace
}  // namespace neuvv
