#include "media/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "media/image.h"

namespace neuvv::media {

namespace {

constexpr uint64_t kMaxExrBytes = uint64_t{4} << 30;
constexpr float kMaxHalf = 65504;
constexpr const char* kColourNames[] = {"R", "G", "B", "A"};

// A stream in memory for the library; write_file_atomically writes the bytes to the disk.
class MemoryOut : public Imf::OStream {
  public:
    MemoryOut() : Imf::OStream("memory") {}
    void write(const char* data, int count) override {
        const auto size = static_cast<size_t>(count);
        if (at_ + size > bytes.size()) bytes.resize(at_ + size);
        std::memcpy(bytes.data() + at_, data, size);
        at_ += size;
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t position) override { at_ = position; }

    std::vector<char> bytes;

  private:
    size_t at_ = 0;
};

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

std::vector<char> encode(const LinearImage& image) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height),
                       static_cast<float>(image.pixel_aspect));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer pixels;
    std::vector<half> colours(image.rgba.size());
    for (size_t i = 0; i < colours.size(); ++i) colours[i] = half(std::clamp(image.rgba[i], -kMaxHalf, kMaxHalf));
    for (size_t c = 0; c < 4; ++c) {
        header.channels().insert(kColourNames[c], Imf::Channel(Imf::HALF));
        pixels.insert(kColourNames[c], Imf::Slice(Imf::HALF, reinterpret_cast<char*>(colours.data() + c),
                                                  4 * sizeof(half), 4 * sizeof(half) * image.width));
    }
    std::vector<float> depth = image.depth_m;
    if (!depth.empty()) {
        header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
        pixels.insert("Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(depth.data()), sizeof(float),
                                      sizeof(float) * image.width));
    }
    MemoryOut out;
    {
        Imf::OutputFile file(out, header);
        file.setFrameBuffer(pixels);
        file.writePixels(static_cast<int>(image.height));
    }  // its destructor completes the table of lines
    return std::move(out.bytes);
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
    assert(image.width > 0 && image.height > 0 && "an image to write has pixels");
    assert(image.rgba.size() == size_t{4} * image.width * image.height && "four values a pixel");
    assert((image.depth_m.empty() || 4 * image.depth_m.size() == image.rgba.size()) && "a depth a pixel, or none");
    std::vector<char> bytes;
    try {
        bytes = encode(image);
    } catch (const std::exception& error) {
        throw RuntimeFailure(fmt::format("{}: cannot encode an EXR: {}", file.string(), error.what()));
    }
    write_file_atomically(file, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
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
