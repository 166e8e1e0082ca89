// An .mp4, .m4a or .mov of packets that are encoded already. It appears when it is complete.
#pragma once

#include <fmt/format.h>

#include "base/error.h"
#include "base/platform.h"
#include "media/libav.h"

namespace neuvv::media {

// All functions throw RuntimeFailure.
class Mp4File {
  public:
    // `ending` is that of a temporary file beside it.
    Mp4File(const std::filesystem::path& path, const char* ending)
        : path_(link_target(path)), temporary_(path_.string() + ending) {}
    ~Mp4File() {  // without finish(), the temporary file is removed
        output_.reset();
        std::error_code ignored;
        if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
    }
    Mp4File(const Mp4File&) = delete;
    Mp4File& operator=(const Mp4File&) = delete;

    const std::filesystem::path& path() const { return path_; }
    // Throws where a function of libav failed.
    void check(int code, const char* what) const {
        if (code < 0) throw RuntimeFailure(fmt::format("{}: cannot {}: {}", path_.string(), what, error_text(code)));
    }

    void open() {
        AVFormatContext* allocated = nullptr;
        check(avformat_alloc_output_context2(&allocated, nullptr, muxer_of(path_), file_url(temporary_).c_str()),
              "open a muxer");
        output_.reset(allocated);
    }
    // Before begin(); owned by this.
    AVStream* add_stream(const AVCodecParameters& parameters, AVRational time_base) {
        AVStream* stream = avformat_new_stream(output_.get(), nullptr);
        if (!stream) throw std::bad_alloc();
        check(avcodec_parameters_copy(stream->codecpar, &parameters), "describe a stream");
        // The muxer's own, but of a .mov, where the muxer would name another profile of ProRes.
        if (!is_mov(path_)) stream->codecpar->codec_tag = 0;
        stream->time_base = time_base;
        return stream;
    }
    void begin(const std::string& comment) {
        if (!comment.empty()) av_dict_set(&output_->metadata, "comment", comment.c_str(), 0);
        check(avio_open(&output_->pb, file_url(temporary_).c_str(), AVIO_FLAG_WRITE), "create the file");
        AVDictionary* options = nullptr;
        av_dict_set(&options, "movflags", "+faststart", 0);
        const int written = avformat_write_header(output_.get(), &options);
        av_dict_free(&options);
        check(written, "write the header");
    }
    void write(AVPacket* packet) { check(av_interleaved_write_frame(output_.get(), packet), "write a frame"); }
    void finish() {
        check(av_write_trailer(output_.get()), "complete the file");
        check(avio_closep(&output_->pb), "close the file");
        replace_file(path_, temporary_);
        temporary_.clear();
    }

  private:
    std::filesystem::path path_, temporary_;
    OwnedOutput output_;
};

// The video of a file, which must outlive it; null where it has none.
inline const AVStream* video_of(AVFormatContext* input) {
    if (avformat_find_stream_info(input, nullptr) < 0) return nullptr;
    const int index = av_find_best_stream(input, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    return index < 0 ? nullptr : input->streams[index];
}

}  // namespace neuvv::media
