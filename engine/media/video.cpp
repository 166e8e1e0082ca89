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

}  // namespace neuvv::media
