// Videos whose container says something: frames at any times, a turn, a timecode, colours. Every frame can be decoded
// by itself.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace neuvv::test {

struct VideoFile {
    std::vector<int64_t> times;        // of the frames, ascending, by time_base
    std::vector<int32_t> matrix = {};  // nine numbers: how the video is to be shown
    std::string timecode = {};         // of the first frame
    AVRational rate = {25, 1};         // that the timecode counts
    AVRational time_base = {1, 1000};  // seconds
    AVRational pixel_aspect = {1, 1};
    AVFieldOrder fields = AV_FIELD_PROGRESSIVE;
    const char* encoder = "mpeg4";
    AVPixelFormat format = AV_PIX_FMT_YUV420P;
    AVColorTransferCharacteristic transfer = AVCOL_TRC_UNSPECIFIED;
    AVColorPrimaries primaries = AVCOL_PRI_UNSPECIFIED;
    AVColorSpace matrix_of_colours = AVCOL_SPC_UNSPECIFIED;
    // Fills frame i; its planes are those of `format`.
    std::function<void(AVFrame&, int)> paint = [](AVFrame& frame, int i) {
        std::memset(frame.data[0], 40 + 5 * i, static_cast<size_t>(frame.linesize[0] * frame.height));
        for (int plane = 1; plane < 3; ++plane)
            std::memset(frame.data[plane], 128, static_cast<size_t>(frame.linesize[plane] * frame.height / 2));
    };
    int width = 64, height = 48;
};

// Paints the luma of 8 bits in quarters: 60 at the top left, 110 at the top right, 160 and 210 below.
inline void paint_quarters(AVFrame& frame, int) {
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x)
            frame.data[0][y * frame.linesize[0] + x] =
                static_cast<uint8_t>(60 + (x * 2 >= frame.width ? 50 : 0) + (y * 2 >= frame.height ? 100 : 0));
    for (int plane = 1; plane < 3; ++plane)
        std::memset(frame.data[plane], 128, static_cast<size_t>(frame.linesize[plane] * frame.height / 2));
}

// The format is that of the path's ending.
inline void write_video_file(const std::filesystem::path& path, const VideoFile& video) {
    const AVCodec* encoder = avcodec_find_encoder_by_name(video.encoder);
    ASSERT_NE(encoder, nullptr);
    AVFormatContext* output = nullptr;
    ASSERT_GE(avformat_alloc_output_context2(&output, nullptr, nullptr, path.c_str()), 0);
    AVCodecContext* codec = avcodec_alloc_context3(encoder);
    codec->width = video.width;
    codec->height = video.height;
    codec->pix_fmt = video.format;
    codec->time_base = video.time_base;
    codec->gop_size = 0;
    codec->global_quality = FF_QP2LAMBDA * 2;
    codec->flags |= AV_CODEC_FLAG_QSCALE;
    codec->sample_aspect_ratio = video.pixel_aspect;
    codec->color_trc = video.transfer;
    codec->color_primaries = video.primaries;
    codec->colorspace = video.matrix_of_colours;
    codec->color_range = AVCOL_RANGE_MPEG;
    if (output->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    ASSERT_GE(avcodec_open2(codec, encoder, nullptr), 0);
    AVStream* stream = avformat_new_stream(output, nullptr);
    ASSERT_GE(avcodec_parameters_from_context(stream->codecpar, codec), 0);
    stream->codecpar->field_order = video.fields;
    stream->time_base = codec->time_base;
    stream->sample_aspect_ratio = video.pixel_aspect;
    stream->avg_frame_rate = video.rate;
    if (!video.timecode.empty()) av_dict_set(&stream->metadata, "timecode", video.timecode.c_str(), 0);
    if (!video.matrix.empty())
        std::memcpy(av_stream_new_side_data(stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(int32_t)),
                    video.matrix.data(), 9 * sizeof(int32_t));
    ASSERT_GE(avio_open(&output->pb, path.c_str(), AVIO_FLAG_WRITE), 0);
    ASSERT_GE(avformat_write_header(output, nullptr), 0);
    AVPacket* packet = av_packet_alloc();
    for (size_t i = 0; i <= video.times.size(); ++i) {
        AVFrame* frame = nullptr;  // null ends the encoding
        if (i < video.times.size()) {
            frame = av_frame_alloc();
            frame->width = video.width;
            frame->height = video.height;
            frame->format = video.format;
            ASSERT_GE(av_frame_get_buffer(frame, 0), 0);
            video.paint(*frame, static_cast<int>(i));
            frame->pts = video.times[i];
        }
        ASSERT_GE(avcodec_send_frame(codec, frame), 0);
        av_frame_free(&frame);
        while (avcodec_receive_packet(codec, packet) >= 0) {
            av_packet_rescale_ts(packet, codec->time_base, stream->time_base);
            packet->stream_index = stream->index;
            ASSERT_GE(av_interleaved_write_frame(output, packet), 0);
        }
    }
    ASSERT_GE(av_write_trailer(output), 0);
    avio_closep(&output->pb);
    av_packet_free(&packet);
    avcodec_free_context(&codec);
    avformat_free_context(output);
}

}  // namespace neuvv::test
