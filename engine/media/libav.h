// What the files share that call libav*: owners of its objects, and the opening of files that may be hostile.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/platform.h"
#include "base/text.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace neuvv::media {

inline std::string error_text(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(code, text, sizeof(text));
    return text;
}

// A URL of the file: in a path without a scheme, a colon would be taken for the end of a protocol's name.
inline std::string file_url(const std::filesystem::path& path) {
    return "file:" + path.string();
}

// Whether the file is a QuickTime movie by its name; else it is an .mp4 or .m4a.
inline bool is_mov(const std::filesystem::path& path) {
    return lower_case(path.extension().string()) == ".mov";
}
inline const char* muxer_of(const std::filesystem::path& path) {
    return is_mov(path) ? "mov" : "mp4";
}

inline void free_packet(AVPacket* packet) {
    av_packet_free(&packet);
}
inline void free_codec(AVCodecContext* codec) {
    avcodec_free_context(&codec);
}
inline void free_frame(AVFrame* frame) {
    av_frame_free(&frame);
}
inline void close_input(AVFormatContext* context) {
    avformat_close_input(&context);
}
inline void close_output(AVFormatContext* context) {
    avio_closep(&context->pb);
    avformat_free_context(context);
}

template <auto release>
struct Release {
    template <typename T>
    void operator()(T* object) const {
        release(object);
    }
};
template <typename T, auto release>
using Owned = std::unique_ptr<T, Release<release>>;

using OwnedCodec = Owned<AVCodecContext, free_codec>;
using OwnedFrame = Owned<AVFrame, free_frame>;
using OwnedPacket = Owned<AVPacket, free_packet>;
using OwnedInput = Owned<AVFormatContext, close_input>;
using OwnedOutput = Owned<AVFormatContext, close_output>;

// Opens a file as a video, so that it cannot make FFmpeg open other files or the network. Returns libav's error code.
// Throws InputError for what is there but no regular file.
inline int open_video_file(const std::filesystem::path& path, AVFormatContext** opened) {
    std::error_code missing;
    if (std::filesystem::exists(path, missing)) expect_regular_file(path);
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    av_dict_set(&options, "format_whitelist", "mp4,matroska,avi,mpegts,mpeg,mxf,asf,ogg,flv", 0);
    const int code = avformat_open_input(opened, file_url(path).c_str(), nullptr, &options);
    av_dict_free(&options);
    return code;
}

}  // namespace neuvv::media
