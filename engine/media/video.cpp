#include "media/video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "media/libav.h"

extern "C" {
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace neuvv::media {

namespace {

constexpr char kCrf[] = "18";        // visually lossless
constexpr int kMpeg4Quantiser = 3;   // the same quality with the fallback encoder
constexpr uint32_t kHdLines = 720;   // from this height on, video without a matrix is taken as BT.709
constexpr int kMaxTimeBase = 65535;  // the finest that MPEG-4 part 2 can store

}  // namespace

struct VideoWriter::State {
    NewFile file;
    const std::filesystem::path& path = file.path();
    uint32_t width = 0, height = 0;  // of the frames that are added; the sides of the video are even
    bool has_alpha = false;          // whether it is a .mov of ProRes 4444
    OwnedOutput output;              // it closes the file before that goes
    OwnedCodec codec;
    OwnedFrame rgba, yuv;
    OwnedPacket packet;
    Owned<SwsContext, sws_freeContext> to_yuv;
    AVStream* stream = nullptr;  // owned by output
    int64_t frames = 0;

    explicit State(const std::filesystem::path& to) : file(to) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() = default;

    [[noreturn]] void fail(const char* what, int code) const {
        throw RuntimeFailure(fmt::format("{}: cannot {}: {}", path.string(), what, error_text(code)));
    }
    void check(int code, const char* what) const {
        if (code < 0) fail(what, code);
    }
    template <typename T>
    T* checked(T* object, const char* what) const {
        if (!object) fail(what, AVERROR(ENOMEM));
        return object;
    }

    bool open_encoder(const char* name, AVRational frame_rate);
    void set_quality(const AVCodec& encoder);
    void open_output(AVRational frame_rate);
    void make_frames();
    void copy_alpha();
    void encode(const AVFrame* frame);
};

void VideoWriter::State::set_quality(const AVCodec& encoder) {
    if (encoder.id == AV_CODEC_ID_PRORES) {
        for (const auto& [option, value] :
             {std::pair("profile", "4444"), std::pair("alpha_bits", "16"), std::pair("vendor", "apl0")})
            check(av_opt_set(codec->priv_data, option, value, 0), "set the quality");
    } else if (encoder.id == AV_CODEC_ID_H264) {
        check(av_opt_set(codec->priv_data, "crf", kCrf, 0), "set the quality");
    } else {
        codec->flags |= AV_CODEC_FLAG_QSCALE;
        codec->global_quality = FF_QP2LAMBDA * kMpeg4Quantiser;
    }
}

// Returns false where this FFmpeg lacks the encoder or the encoder refuses the size.
bool VideoWriter::State::open_encoder(const char* name, AVRational frame_rate) {
    const AVCodec* encoder = avcodec_find_encoder_by_name(name);
    if (!encoder) return false;
    codec.reset(checked(avcodec_alloc_context3(encoder), "make an encoder"));
    codec->width = static_cast<int>(video_side(width));
    codec->height = static_cast<int>(video_side(height));
    codec->pix_fmt = has_alpha ? AV_PIX_FMT_YUVA444P10 : AV_PIX_FMT_YUV420P;
    codec->framerate = frame_rate;
    codec->time_base = av_inv_q(frame_rate);
    codec->color_range = AVCOL_RANGE_MPEG;
    codec->colorspace = AVCOL_SPC_BT709;
    codec->color_primaries = AVCOL_PRI_BT709;
    codec->color_trc = AVCOL_TRC_BT709;
    if (output->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    set_quality(*encoder);
    return avcodec_open2(codec.get(), encoder, nullptr) >= 0;
}

void VideoWriter::State::open_output(AVRational frame_rate) {
    const std::string url = file_url(file.name_to_open());
    AVFormatContext* allocated = nullptr;
    check(avformat_alloc_output_context2(&allocated, nullptr, muxer_of(path), url.c_str()), "open a muxer");
    output.reset(allocated);
    const bool opened = has_alpha ? open_encoder("prores_ks", frame_rate)
                                  : open_encoder("libx264", frame_rate) || open_encoder("mpeg4", frame_rate);
    if (!opened)
        throw RuntimeFailure(fmt::format("{}: no video encoder opens for {}×{}; install an FFmpeg with {}",
                                         path.string(), video_side(width), video_side(height),
                                         has_alpha ? "prores_ks" : "libx264 or mpeg4"));
    stream = checked(avformat_new_stream(output.get(), nullptr), "add a stream");
    stream->time_base = codec->time_base;
    stream->avg_frame_rate = frame_rate;
    check(avcodec_parameters_from_context(stream->codecpar, codec.get()), "describe the stream");
    check(avio_open(&output->pb, url.c_str(), AVIO_FLAG_WRITE), "create the file");
    AVDictionary* options = nullptr;
    const int set = av_dict_set(&options, "movflags", "+faststart", 0);
    const int written = set < 0 ? set : avformat_write_header(output.get(), &options);
    av_dict_free(&options);
    check(written, "write the header");
}

void VideoWriter::State::make_frames() {
    packet.reset(checked(av_packet_alloc(), "make a packet"));
    for (OwnedFrame* frame : {&rgba, &yuv}) {
        frame->reset(checked(av_frame_alloc(), "make a frame"));
        (*frame)->width = codec->width;
        (*frame)->height = codec->height;
        (*frame)->format = frame == &rgba ? AV_PIX_FMT_RGBA : codec->pix_fmt;
        check(av_frame_get_buffer(frame->get(), 0), "allocate a frame");
    }
    yuv->color_range = codec->color_range;
    yuv->colorspace = codec->colorspace;
    yuv->color_primaries = codec->color_primaries;
    yuv->color_trc = codec->color_trc;
    const int flags = SWS_BICUBIC | SWS_ACCURATE_RND | (has_alpha ? SWS_FULL_CHR_H_INP : 0);
    to_yuv.reset(checked(sws_getContext(codec->width, codec->height, AV_PIX_FMT_RGBA, codec->width, codec->height,
                                        codec->pix_fmt, flags, nullptr, nullptr, nullptr),
                         "convert to YUV"));
    // From full-range RGB to limited-range BT.709; the default matrix of swscale is BT.601.
    const int* matrix = sws_getCoefficients(SWS_CS_ITU709);
    check(sws_setColorspaceDetails(to_yuv.get(), matrix, 1, matrix, 0, 0, 1 << 16, 1 << 16), "convert to BT.709");
}

// swscale makes 1020 of 255 where the largest alpha of ten bits is 1023.
void VideoWriter::State::copy_alpha() {
    constexpr int kPlane = 3;
    for (int y = 0; y < yuv->height; ++y) {
        const uint8_t* from = rgba->data[0] + ptrdiff_t{y} * rgba->linesize[0] + 3;
        auto* to = reinterpret_cast<uint16_t*>(yuv->data[kPlane] + ptrdiff_t{y} * yuv->linesize[kPlane]);
        for (int x = 0; x < yuv->width; ++x) to[x] = static_cast<uint16_t>((from[4 * x] * 1023 + 127) / 255);
    }
}

// Gives a frame to the encoder (null: the end) and writes the packets that it returns.
void VideoWriter::State::encode(const AVFrame* frame) {
    check(avcodec_send_frame(codec.get(), frame), "encode a frame");
    for (;;) {
        const int got = avcodec_receive_packet(codec.get(), packet.get());
        if (got == AVERROR(EAGAIN) || got == AVERROR_EOF) return;
        check(got, "encode a frame");
        packet->duration = 1;
        packet->stream_index = stream->index;
        av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
        check(av_interleaved_write_frame(output.get(), packet.get()), "write a frame");
    }
}

VideoWriter::VideoWriter(const std::filesystem::path& path, uint32_t width, uint32_t height, double fps)
    : state_(std::make_unique<State>(path)) {
    State& state = *state_;
    if (width == 0 || height == 0 || width > kMaxImageSide || height > kMaxImageSide)
        throw RuntimeFailure(fmt::format("{}: a video of {}×{} cannot be written", path.string(), width, height));
    const AVRational frame_rate = std::isfinite(fps) && fps > 0 ? av_d2q(fps, kMaxTimeBase) : AVRational{0, 1};
    if (frame_rate.num <= 0 || frame_rate.den <= 0)
        throw RuntimeFailure(fmt::format("{}: a video of {} frames a second cannot be written", path.string(), fps));
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    state.width = width;
    state.height = height;
    state.has_alpha = is_mov(state.path);
    state.open_output(frame_rate);
    state.make_frames();
}

VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

void VideoWriter::add(const Image& image) {
    State& state = *state_;
    if (image.width != state.width || image.height != state.height)
        throw RuntimeFailure(fmt::format("{}: frame {} is {}×{}, the video {}×{}", state.path.string(), state.frames,
                                         image.width, image.height, state.width, state.height));
    AVFrame& rgba = *state.rgba;
    for (int y = 0; y < rgba.height; ++y) {  // the last row and column repeat where the size is odd
        const uint32_t from = std::min(static_cast<uint32_t>(y), image.height - 1);
        uint8_t* row = rgba.data[0] + ptrdiff_t{y} * rgba.linesize[0];
        std::memcpy(row, image.at(0, from), size_t{4} * image.width);
        if (image.width & 1) std::memcpy(row + size_t{4} * image.width, image.at(image.width - 1, from), 4);
    }
    // The encoder may still use the last frame.
    state.check(av_frame_make_writable(state.yuv.get()), "allocate a frame");
    state.check(
        sws_scale(state.to_yuv.get(), rgba.data, rgba.linesize, 0, rgba.height, state.yuv->data, state.yuv->linesize),
        "convert a frame");
    if (state.has_alpha) state.copy_alpha();
    state.yuv->pts = state.frames++;
    state.encode(state.yuv.get());
}

void VideoWriter::finish() {
    State& state = *state_;
    if (state.frames == 0) throw RuntimeFailure(fmt::format("{}: a video needs frames", state.path.string()));
    state.encode(nullptr);
    state.check(av_write_trailer(state.output.get()), "complete the file");
    state.check(avio_closep(&state.output->pb), "close the file");
    state.file.finish();
}

struct VideoReader::State {
    std::filesystem::path path;
    OwnedInput input;
    OwnedCodec codec;
    OwnedFrame frame, rgba;
    OwnedPacket packet;
    Owned<SwsContext, sws_freeContext> to_rgba;
    int index = 0;  // of the video stream
    ImageSize size;
    uint32_t frames = 0, decoded = 0;
    double fps = 0;
    bool drained = false;  // the decoder knows that no more packets follow

    [[noreturn]] void fail(const std::string& problem, const std::string& fix = "") const {
        throw InputError(path.string(), decoded ? fmt::format("frame {}", decoded) : "", problem, fix);
    }
    void check(int code, const char* what) const {
        if (code < 0) fail(fmt::format("{}: {}", what, error_text(code)));
    }
    void open();
    void open_decoder();
    uint32_t count_packets();
    bool decode();
    void convert(Image& image);
};

void VideoReader::State::open() {
    AVFormatContext* opened = nullptr;
    check(open_video_file(path, &opened), "cannot open as a video");
    input.reset(opened);
    check(avformat_find_stream_info(opened, nullptr), "cannot find its streams");
}

void VideoReader::State::open_decoder() {
    const AVCodec* decoder = nullptr;
    index = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
    check(index, "no video stream");
    const AVStream& stream = *input->streams[index];
    codec.reset(avcodec_alloc_context3(decoder));
    frame.reset(av_frame_alloc());
    packet.reset(av_packet_alloc());
    if (!codec || !frame || !packet) throw RuntimeFailure("out of memory while decoding a video");
    check(avcodec_parameters_to_context(codec.get(), stream.codecpar), "cannot decode");
    codec->max_pixels = int64_t{kMaxImageSide} * kMaxImageSide;
    codec->thread_count = 1;  // many videos are read at once
    check(avcodec_open2(codec.get(), decoder, nullptr), "cannot decode");
    const int width = stream.codecpar->width, height = stream.codecpar->height;
    if (width <= 0 || height <= 0 || width > static_cast<int>(kMaxImageSide) ||
        height > static_cast<int>(kMaxImageSide))
        fail(fmt::format("is {}×{}, not an image size of 1 to {}", width, height, kMaxImageSide));
    size = {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
    const AVRational rate = stream.avg_frame_rate.num > 0 ? stream.avg_frame_rate : stream.r_frame_rate;
    fps = rate.den > 0 ? av_q2d(rate) : 0;
}

uint32_t VideoReader::State::count_packets() {
    uint32_t count = 0;
    for (int read = 0; (read = av_read_frame(input.get(), packet.get())) != AVERROR_EOF;) {
        check(read, "cannot read");
        count += packet->stream_index == index && packet->size > 0;
        av_packet_unref(packet.get());
    }
    return count;
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
        const int read = av_read_frame(input.get(), packet.get());
        drained = read == AVERROR_EOF;
        if (!drained) check(read, "cannot read");
        if (drained || packet->stream_index == index)
            check(avcodec_send_packet(codec.get(), drained ? nullptr : packet.get()), "damaged frame");
        av_packet_unref(packet.get());
    }
    if (decoded == 0 || decoded < frames)
        fail(fmt::format("holds {} of {} frames", decoded, frames), "the file was cut short: write it again");
    return false;
}

void VideoReader::State::convert(Image& image) {
    if (!rgba) {
        rgba.reset(av_frame_alloc());
        if (!rgba) throw RuntimeFailure("out of memory while decoding a video");
        rgba->width = static_cast<int>(size.width);
        rgba->height = static_cast<int>(size.height);
        rgba->format = AV_PIX_FMT_RGBA;
        check(av_frame_get_buffer(rgba.get(), 0), "cannot allocate a frame");
    }
    to_rgba.reset(sws_getCachedContext(
        to_rgba.release(), frame->width, frame->height, static_cast<AVPixelFormat>(frame->format), rgba->width,
        rgba->height, AV_PIX_FMT_RGBA, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT, nullptr, nullptr, nullptr));
    if (!to_rgba) fail("its pixel format cannot be converted to RGB");
    const bool named = frame->colorspace != AVCOL_SPC_UNSPECIFIED && frame->colorspace != AVCOL_SPC_RGB;
    const int matrix = named ? frame->colorspace : size.height >= kHdLines ? SWS_CS_ITU709 : SWS_CS_ITU601;
    const int full_range = frame->color_range == AVCOL_RANGE_JPEG;
    // This fails for formats that are RGB already, which need no matrix.
    sws_setColorspaceDetails(to_rgba.get(), sws_getCoefficients(matrix), full_range,
                             sws_getCoefficients(SWS_CS_DEFAULT), 1, 0, 1 << 16, 1 << 16);
    check(sws_scale(to_rgba.get(), frame->data, frame->linesize, 0, frame->height, rgba->data, rgba->linesize),
          "cannot convert a frame");
    image = Image(size.width, size.height);
    for (uint32_t y = 0; y < size.height; ++y)
        std::memcpy(image.at(0, y), rgba->data[0] + static_cast<ptrdiff_t>(y) * rgba->linesize[0],
                    size_t{4} * size.width);
}

VideoReader::VideoReader(const std::filesystem::path& path) : state_(std::make_unique<State>()) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    State& state = *state_;
    state.path = path;
    state.open();
    state.open_decoder();
    const int64_t indexed = state.input->streams[state.index]->nb_frames;
    std::error_code ignored;
    const auto bytes = static_cast<int64_t>(std::filesystem::file_size(path, ignored));
    if (indexed > bytes) state.fail(fmt::format("claims {} frames in {} bytes", indexed, bytes));
    if (indexed > 0) {
        state.frames = static_cast<uint32_t>(std::min<int64_t>(indexed, UINT32_MAX));
        return;
    }
    state.frames = state.count_packets();
    if (state.frames == 0) state.fail("holds no frame");
    state.open();
    state.open_decoder();
}

VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

ImageSize VideoReader::size() const {
    return state_->size;
}
uint32_t VideoReader::frames() const {
    return state_->frames;
}
double VideoReader::fps() const {
    return state_->fps;
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
