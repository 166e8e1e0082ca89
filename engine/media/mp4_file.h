// An .mp4, .m4a or .mov of packets that are encoded already. It appears when it is complete.
#pragma once

#include <fmt/format.h>

#include "base/error.h"
#include "base/new_file.h"
#include "media/libav.h"

namespace neuvv::media {

// All functions throw RuntimeFailure.
class Mp4File {
  public:
    explicit Mp4File(const std::filesystem::path& path) : file_(path) {}

    const std::filesystem::path& path() const { return file_.path(); }
    // Throws where a function of libav failed.
    void check(int code, const char* what) const {
        if (code < 0) throw RuntimeFailure(fmt::format("{}: cannot {}: {}", path().string(), what, error_text(code)));
    }

    void open() {
        AVFormatContext* allocated = nullptr;
        check(avformat_alloc_output_context2(&allocated, nullptr, muxer_of(path()),
                                             file_url(file_.name_to_open()).c_str()),
              "open a muxer");
        output_.reset(allocated);
    }
    // Before begin(); owned by this.
    AVStream* add_stream(const AVCodecParameters& parameters, AVRational time_base) {
        AVStream* stream = avformat_new_stream(output_.get(), nullptr);
        if (!stream) throw std::bad_alloc();
        check(avcodec_parameters_copy(stream->codecpar, &parameters), "describe a stream");
        // The muxer's own, but of a .mov, where the muxer would name another profile of ProRes.
        if (!is_mov(path())) stream->codecpar->codec_tag = 0;
        stream->time_base = time_base;
        return stream;
    }
    void begin(const std::string& comment) {
        if (!comment.empty()) av_dict_set(&output_->metadata, "comment", comment.c_str(), 0);
        check(avio_open(&output_->pb, file_url(file_.name_to_open()).c_str(), AVIO_FLAG_WRITE), "create the file");
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
        file_.finish();
    }

  private:
    NewFile file_;
    OwnedOutput output_;  // it closes the file before that goes
};

// The video of a file, which must outlive it; null where it has none.
inline const AVStream* video_of(AVFormatContext* input) {
    if (avformat_find_stream_info(input, nullptr) < 0) return nullptr;
    const int index = av_find_best_stream(input, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    return index < 0 ? nullptr : input->streams[index];
}

}  // namespace neuvv::media
