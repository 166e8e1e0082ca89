#include "media/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "media/exr_memory.h"
#include "media/image.h"

namespace neuvv::media {

namespace {

constexpr uint64_t kMaxExrBytes = uint64_t{4} << 30;
constexpr const char* kColourNames[] = {"R", "G", "B", "A"};

class MemoryIn : public Imf::IStream {
  public:
    MemoryIn(const std::string& name, const std::vector<uint8_t>& bytes) : Imf::IStream(name.c_str()), bytes_(bytes) {}
    bool read(char* data, int count) override {
        const auto size = static_cast<size_t>(count);
        if (at_ > bytes_.size() || size > bytes_.size() - at_) throw std::runtime_error("the file ends too early");
        std::memcpy(data, bytes_.data() + at_, size);
        at_ += size;
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t position) override { at_ = position; }

  private:
    const std::vector<uint8_t>& bytes_;
    size_t at_ = 0;
};

// Channels whose values lie pixel by pixel behind each other in rows of `width` pixels.
template <typename T>
void add_channels(Imf::Header& header, Imf::FrameBuffer& pixels, Imf::PixelType type,
                  const std::vector<std::string>& names, std::vector<T>& values, uint32_t width) {
    const size_t stride = names.size() * sizeof(T);
    for (size_t c = 0; c < names.size(); ++c) {
        header.channels().insert(names[c], Imf::Channel(type));
        pixels.insert(names[c], Imf::Slice(type, reinterpret_cast<char*>(values.data() + c), stride, stride * width));
    }
}

std::vector<char> encode(const LinearImage& image) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height),
                       static_cast<float>(image.pixel_aspect));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer pixels;
    std::vector<half> colours(image.rgba.size());
    std::transform(image.rgba.begin(), image.rgba.end(), colours.begin(), half_of);
    std::vector<float> depth = image.depth_m, ids;
    if (!colours.empty()) add_channels(header, pixels, Imf::HALF, {"R", "G", "B", "A"}, colours, image.width);
    if (!depth.empty()) add_channels(header, pixels, Imf::FLOAT, {"Z"}, depth, image.width);
    if (!image.ids.pixels.empty()) {
        ids = id_values(image.ids);
        add_channels(header, pixels, Imf::FLOAT, id_channels(), ids, image.width);
        for (const auto& [name, text] : id_attributes(image.ids)) header.insert(name, Imf::StringAttribute(text));
    }
    return encoded([&](Imf::OStream& out) {
        Imf::OutputFile file(out, header);
        file.setFrameBuffer(pixels);
        file.writePixels(static_cast<int>(image.height));
    });
}

// Throws exceptions of the library, and InputError.
LinearImage decode(const std::string& name, const std::vector<uint8_t>& bytes) {
    constexpr int kMaxSide = static_cast<int>(kMaxImageSide);
    Imf::Header::setMaxImageSize(kMaxSide, kMaxSide);  // before any memory is allocated
    Imf::Header::setMaxTileSize(kMaxSide, kMaxSide);
    MemoryIn in(name, bytes);
    Imf::InputFile file(in);
    const Imath::Box2i window = file.header().dataWindow();
    const int64_t width = int64_t{window.max.x} - window.min.x + 1, height = int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide ||
        static_cast<uint64_t>(width * height) > kMaxExrPixels)
        throw InputError(name, "dataWindow", fmt::format("is {}×{} pixels", width, height),
                         fmt::format("a side has 1 to {}, an image at most {}", kMaxSide, kMaxExrPixels));
    expect_content({static_cast<uint32_t>(width), static_cast<uint32_t>(height)}, bytes.size(), name);
    for (const char* colour : {"R", "G", "B"})
        if (!file.header().channels().findChannel(colour))
            throw InputError(name, "channels", fmt::format("has no {}", colour), "export it as RGB or RGBA");
    LinearImage image;
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    image.pixel_aspect = file.header().pixelAspectRatio();
    const size_t count = size_t{image.width} * image.height;
    image.rgba.resize(4 * count);
    Imf::FrameBuffer pixels;
    for (size_t c = 0; c < 4; ++c)
        pixels.insert(kColourNames[c], Imf::Slice::Make(Imf::FLOAT, image.rgba.data() + c, window, 4 * sizeof(float),
                                                        4 * sizeof(float) * image.width, 1, 1, c == 3 ? 1 : 0));
    if (file.header().channels().findChannel("Z")) {
        image.depth_m.resize(count);
        pixels.insert("Z", Imf::Slice::Make(Imf::FLOAT, image.depth_m.data(), window, sizeof(float),
                                            sizeof(float) * image.width));
    }
    file.setFrameBuffer(pixels);
    file.readPixels(window.min.y, window.max.y);
    return image;
}

}  // namespace

void write_exr(const std::filesystem::path& file, const LinearImage& image) {
    [[maybe_unused]] const size_t pixels = size_t{image.width} * image.height;
    assert(pixels > 0 && "an image to write has pixels");
    assert((image.rgba.empty() || image.rgba.size() == 4 * pixels) && "four values a pixel, or none");
    assert((image.depth_m.empty() || image.depth_m.size() == pixels) && "a depth a pixel, or none");
    assert((image.ids.pixels.empty() || image.ids.pixels.size() == pixels) && "ranks a pixel, or none");
    write_encoded(file, [&] { return encode(image); });
}

LinearImage read_exr(const std::filesystem::path& file) {
    const std::string name = file.string();
    const std::vector<uint8_t> bytes = read_file(file, kMaxExrBytes);
    LinearImage image;
    try {
        image = decode(name, bytes);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        std::string text = error.what();  // the library's text may have several lines and name the file
        std::replace(text.begin(), text.end(), '\n', ' ');
        throw InputError(name, "", fmt::format("damaged or unsupported EXR: {:.300}", text),
                         "export the image again, as a flat RGB or RGBA file");
    }
    const auto bad = std::find_if_not(image.rgba.begin(), image.rgba.end(), [](float v) { return std::isfinite(v); });
    if (bad != image.rgba.end()) {
        const auto pixel = static_cast<size_t>(bad - image.rgba.begin()) / 4;
        throw InputError(name, fmt::format("pixel {}, {}", pixel % image.width, pixel / image.width),
                         "has a colour that is not finite", "export the image without such pixels");
    }
    return image;
}

}  // namespace neuvv::media
