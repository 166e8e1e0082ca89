#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "media/orientation.h"
#include "media/video.h"
#include "media/video_colour.h"
#include "media/video_input.h"

extern "C" {
#include <libavutil/dovi_meta.h>
#include <libswscale/swscale.h>
}

namespace neuvv::media {

namespace {

constexpr int64_t kMaxVideo_pixels = int64_t{1} << 26;  // H.264, HEVC and AV1 end at half of them
constexpr uint32_t kHdLines = 720;  // from this height on, video without a matrix is taken as BT.709

// What a stream, and a frame of H.264 or HEVC, says by a matrix.
std::optional<Orientation> orientation_of(const uint8_t* matrix, size_t bytes) {
    int32_t numbers[9] = {};
    if (!matrix || bytes < sizeof(numbers)) return Orientation::kUpright;
    std::memcpy(numbers, matrix, sizeof(numbers));
    return matrix_orientation(numbers);
}
std::optional<Orientation> orientation_of(const AVStream& stream) {
    size_t bytes = 0;
    const uint8_t* matrix = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &bytes);
    return orientation_of(matrix, bytes);
}

bool is_interlaced(const AVCodecParameters& stream) {
    return stream.field_order != AV_FIELD_UNKNOWN && stream.field_order != AV_FIELD_PROGRESSIVE;
}

// Profile 5 of Dolby Vision has colours of its own, which are those of no other standard.
bool has_colours_of_dolby(const AVStream& stream) {
    size_t bytes = 0;
    const uint8_t* data = av_stream_get_side_data(&stream, AV_PKT_DATA_DOVI_CONF, &bytes);
    return data && bytes >= sizeof(AVDOVIDecoderConfigurationRecord) &&
           reinterpret_cast<const AVDOVIDecoderConfigurationRecord*>(data)->dv_profile == 5;
}

}  // namespace

struct VideoReader::State {
    std::optional<VideoInput> input;
    OwnedCodec codec;
    OwnedFrame frame, rgba;
    Owned<SwsContext, sws_freeContext> to_rgba;
    std::optional<VideoColour> colour;  // of the last frame
    AVColorTransferCharacteristic transfer = AVCOL_TRC_UNSPECIFIED;
    AVColorPrimaries primaries = AVCOL_PRI_UNSPECIFIED;
    ImageSize size;  // as stored
    Orientation orientation = Orientation::kUpright;
    uint32_t frames = 0, decoded = 0;
    bool drained = false;  // the decoder knows that no more packets follow

    [[noreturn]] void fail(const std::string& problem, const std::string& fix = "") const {
        throw InputError(input->path().string(), decoded ? fmt::format("frame {}", decoded) : "", problem, fix);
    }
    void check(int code, const char* what) const {
        if (code < 0) fail(fmt::format("{}: {}", what, error_text(code)));
    }
    void open_decoder();
    bool decode();
    Orientation orientation_of_frame() const;
    void convert(Image& image);
    AVFrame& scaled_to(AVPixelFormat format);
};

void VideoReader::State::open_decoder() {
    const AVStream& stream = input->stream();
    codec.reset(avcodec_alloc_context3(input->decoder()));
    frame.reset(av_frame_alloc());
    if (!codec || !frame) throw RuntimeFailure("out of memory while decoding a video");
    check(avcodec_parameters_to_context(codec.get(), stream.codecpar), "cannot decode");
    codec->max_pixels = kMaxVideo_pixels;
    codec->thread_count = 1;  // many videos are read at once
    check(avcodec_open2(codec.get(), input->decoder(), nullptr), "cannot decode");
    const int width = stream.codecpar->width, height = stream.codecpar->height;
    if (width <= 0 || height <= 0 || width > static_cast<int>(kMaxImageSide) ||
        height > static_cast<int>(kMaxImageSide) || int64_t{width} * height > kMaxVideo_pixels)
        fail(fmt::format("is {}×{}, not an image size of 1 to {}", width, height, kMaxImageSide));
    size = {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
    orientation = orientation_of(stream).value_or(Orientation::kUpright);
}

// Decodes the next frame into `frame`; returns false at the end.
bool VideoReader::State::decode() {
    for (;;) {
        const int got = avcodec_receive_frame(codec.get(), frame.get());
        if (got == AVERROR_EOF) break;
        if (got != AVERROR(EAGAIN)) {
            check(got, "damaged frame");
            if (frame->width != static_cast<int>(size.width) || frame->height != static_cast<int>(size.height))
                fail(fmt::format("the image's size changes from {}×{} to {}×{}", size.width, size.height, frame->width,
                                 frame->height));
            ++decoded;
            return true;
        }
        if (drained) break;
        const AVPacket* packet = input->read();
        drained = packet == nullptr;
        check(avcodec_send_packet(codec.get(), packet), "damaged frame");
    }
    if (decoded == 0 || decoded < frames)
        fail(fmt::format("holds {} of {} frames", decoded, frames), "the file was cut short: write it again");
    return false;
}

// A frame of H.264 or HEVC may say it, too, and then counts, as in other players.
Orientation VideoReader::State::orientation_of_frame() const {
    const AVFrameSideData* data = av_frame_get_side_data(frame.get(), AV_FRAME_DATA_DISPLAYMATRIX);
    if (!data) return orientation;
    const Orientation own = orientation_of(data->data, data->size).value_or(Orientation::kUpright);
    if (exchanges_sides(own) != exchanges_sides(orientation))
        fail(fmt::format("is to be shown {}, which only its frames say, not its header", orientation_text(own)),
             "write it again by `ffmpeg -i in.mp4 out.mp4`, which turns the images themselves");
    return own;
}

// The frame as R, G, B and A of this format.
AVFrame& VideoReader::State::scaled_to(AVPixelFormat format) {
    if (!rgba || rgba->format != format) {
        rgba.reset(av_frame_alloc());
        if (!rgba) throw RuntimeFailure("out of memory while decoding a video");
        rgba->width = static_cast<int>(size.width);
        rgba->height = static_cast<int>(size.height);
        rgba->format = format;
        check(av_frame_get_buffer(rgba.get(), 0), "cannot allocate a frame");
    }
    to_rgba.reset(sws_getCachedContext(to_rgba.release(), frame->width, frame->height,
                                       static_cast<AVPixelFormat>(frame->format), rgba->width, rgba->height, format,
                                       SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT, nullptr, nullptr, nullptr));
    if (!to_rgba) fail("its pixel format cannot be converted to RGB");
    const bool named = frame->colorspace != AVCOL_SPC_UNSPECIFIED && frame->colorspace != AVCOL_SPC_RGB;
    const int matrix = !named ? size.height >= kHdLines ? SWS_CS_ITU709 : SWS_CS_ITU601
                       : frame->colorspace == AVCOL_SPC_BT2020_CL ? SWS_CS_BT2020
                                                                  : static_cast<int>(frame->colorspace);
    const int full_range = frame->color_range == AVCOL_RANGE_JPEG;
    // This fails for formats that are RGB already, which need no matrix.
    sws_setColorspaceDetails(to_rgba.get(), sws_getCoefficients(matrix), full_range,
                             sws_getCoefficients(SWS_CS_DEFAULT), 1, 0, 1 << 16, 1 << 16);
    check(sws_scale(to_rgba.get(), frame->data, frame->linesize, 0, frame->height, rgba->data, rgba->linesize),
          "cannot convert a frame");
    return *rgba;
}

void VideoReader::State::convert(Image& image) {
    if (frame->color_trc != transfer || frame->color_primaries != primaries) {
        transfer = frame->color_trc;
        primaries = frame->color_primaries;
        colour = VideoColour::of(transfer, primaries);
    }
    const AVFrame& pixels = scaled_to(colour ? AV_PIX_FMT_RGBA64 : AV_PIX_FMT_RGBA);
    image = Image(size.width, size.height);
    for (uint32_t y = 0; y < size.height; ++y) {
        const uint8_t* row = pixels.data[0] + static_cast<ptrdiff_t>(y) * pixels.linesize[0];
        if (colour)
            colour->to_srgb(reinterpret_cast<const uint16_t*>(row), image.at(0, y), size.width);
        else
            std::memcpy(image.at(0, y), row, size_t{4} * size.width);
    }
    image = shown(std::move(image), orientation_of_frame());
}

VideoReader::VideoReader(const std::filesystem::path& path) : state_(std::make_unique<State>()) {
    State& state = *state_;
    state.input.emplace(path);
    state.open_decoder();
    const std::vector<const AVIndexEntry*> frames = state.input->frames();
    state.frames = static_cast<uint32_t>(
        std::count_if(frames.begin(), frames.end(), [](const AVIndexEntry* entry) { return is_shown(*entry); }));
    if (!frames.empty()) return;
    while (const AVPacket* packet = state.input->read()) state.frames += is_shown(*packet);
    if (state.frames == 0) state.fail("holds no frame");
    state.input.emplace(path);
}

VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

ImageSize VideoReader::size() const {
    return shown_size(state_->size, state_->orientation);
}
double VideoReader::pixel_aspect() const {
    const AVStream& stream = state_->input->stream();
    const AVRational own =
        stream.sample_aspect_ratio.num > 0 ? stream.sample_aspect_ratio : stream.codecpar->sample_aspect_ratio;
    if (own.num <= 0 || own.den <= 0) return 1;
    return exchanges_sides(state_->orientation) ? 1 / av_q2d(own) : av_q2d(own);
}
uint32_t VideoReader::frames() const {
    return state_->frames;
}
double VideoReader::fps() const {
    const AVStream& stream = state_->input->stream();
    const AVRational rate = stream.avg_frame_rate.num > 0 ? stream.avg_frame_rate : stream.r_frame_rate;
    return rate.den > 0 ? av_q2d(rate) : 0;
}

std::vector<std::string> VideoReader::notes() const {
    const AVStream& stream = state_->input->stream();
    std::vector<std::string> notes;
    if (!orientation_of(stream))
        notes.emplace_back("to be turned by an angle that is no quarter, which is not done");
    else if (state_->orientation != Orientation::kUpright)
        notes.push_back(fmt::format("shown {}, as the file says", orientation_text(state_->orientation)));
    if (has_colours_of_dolby(stream))
        notes.emplace_back("Dolby Vision of profile 5, whose colours cannot be converted: they are wrong");
    else if (const std::string note = colour_note(*stream.codecpar); !note.empty())
        notes.push_back(note);
    if (const double aspect = pixel_aspect(); std::abs(aspect - 1) > 1e-3)
        notes.push_back(fmt::format("pixels {:.4g} times as wide as high, which are used as they are stored", aspect));
    if (is_interlaced(*stream.codecpar))
        notes.emplace_back(
            "interlaced, two moments woven into one image: `ffmpeg -i in.mp4 -vf bwdif out.mp4` parts them");
    return notes;
}

bool VideoReader::next(Image& frame) {
    if (!state_->decode()) return false;
    state_->convert(frame);
    return true;
}

bool VideoReader::skip() {
    return state_->decode();
}

VideoSummary summarise_video(const std::filesystem::path& path) {
    VideoReader reader(path);
    VideoSummary summary{reader.size().width, reader.size().height, 0, reader.fps()};
    while (reader.skip()) ++summary.frames;
    return summary;
}

}  // namespace neuvv::media
