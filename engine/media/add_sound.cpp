#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/platform.h"
#include "media/libav.h"
#include "media/sound.h"
#include "media/video.h"

namespace neuvv::media {

namespace {

constexpr int64_t kBitRate = 192'000;

// A video that is copied, with a track beside it.
class VideoWithSound {
  public:
    VideoWithSound(const std::filesystem::path& video, const NextSamples& next)
        : path_(link_target(video)), temporary_(path_.string() + ".sound.mp4"), next_(next) {
        open_input();
        open_encoder();
        open_output();
    }
    ~VideoWithSound() {
        output_.reset();
        std::error_code ignored;
        if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
    }
    VideoWithSound(const VideoWithSound&) = delete;
    VideoWithSound& operator=(const VideoWithSound&) = delete;

    void write() {
        for (int read = 0; (read = av_read_frame(input_.get(), packet_.get())) != AVERROR_EOF;) {
            if (read < 0) fail("cannot be read to its end");
            if (packet_->stream_index == from_->index) copy_image();
            av_packet_unref(packet_.get());
        }
        encode_until(length_s());
        encode(nullptr);
        check(av_write_trailer(output_.get()), "complete the file");
        check(avio_closep(&output_->pb), "close the file");
        replace_file(path_, temporary_);
        temporary_.clear();
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(path_.string(), "", problem, "render the video again");
    }
    void check(int code, const char* what) const {
        if (code < 0) throw RuntimeFailure(fmt::format("{}: cannot {}: {}", path_.string(), what, error_text(code)));
    }
    double length_s() const { return static_cast<double>(from_->nb_frames) / av_q2d(from_->avg_frame_rate); }

    void open_input() {
        AVFormatContext* opened = nullptr;
        if (open_video_file(path_, &opened) < 0) fail("cannot be opened as a video");
        input_.reset(opened);
        const int found = avformat_find_stream_info(opened, nullptr);
        const int index = found < 0 ? found : av_find_best_stream(opened, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
        if (index < 0) fail("has no video");
        from_ = opened->streams[index];
        if (from_->nb_frames <= 0 || from_->avg_frame_rate.num <= 0 || from_->avg_frame_rate.den <= 0)
            fail("does not say how many images it has");
    }
    void open_encoder() {
        const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_AAC);
        if (!codec) throw RuntimeFailure("the installed FFmpeg has no AAC encoder");
        encoder_.reset(avcodec_alloc_context3(codec));
        packet_.reset(av_packet_alloc());
        coded_.reset(av_packet_alloc());
        frame_.reset(av_frame_alloc());
        if (!encoder_ || !packet_ || !coded_ || !frame_) throw std::bad_alloc();
        encoder_->bit_rate = kBitRate;
        encoder_->sample_fmt = AV_SAMPLE_FMT_FLTP;
        encoder_->sample_rate = kSoundRate;
        encoder_->time_base = {1, kSoundRate};
        encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;  // as .mp4 needs it
        av_channel_layout_default(&encoder_->ch_layout, 2);
        check(avcodec_open2(encoder_.get(), codec, nullptr), "open the AAC encoder");
        if (encoder_->frame_size != static_cast<int>(kSoundHop))
            throw RuntimeFailure("the installed FFmpeg's AAC encoder has another frame size than 1024");
        frame_->format = encoder_->sample_fmt;
        frame_->nb_samples = encoder_->frame_size;
        frame_->sample_rate = kSoundRate;
        check(av_channel_layout_copy(&frame_->ch_layout, &encoder_->ch_layout), "describe the sound");
        check(av_frame_get_buffer(frame_.get(), 0), "have memory for a sound");
    }
    void open_output() {
        AVFormatContext* allocated = nullptr;
        check(avformat_alloc_output_context2(&allocated, nullptr, "mp4", file_url(temporary_).c_str()), "open a muxer");
        output_.reset(allocated);
        images_ = avformat_new_stream(allocated, nullptr);
        sound_ = avformat_new_stream(allocated, nullptr);
        if (!images_ || !sound_) throw std::bad_alloc();
        check(avcodec_parameters_copy(images_->codecpar, from_->codecpar), "describe the images");
        images_->codecpar->codec_tag = 0;  // the muxer's own
        images_->time_base = from_->time_base;
        images_->avg_frame_rate = from_->avg_frame_rate;
        check(avcodec_parameters_from_context(sound_->codecpar, encoder_.get()), "describe the sound");
        sound_->time_base = encoder_->time_base;
        const std::string comment = comment_of_video(path_);
        if (!comment.empty()) av_dict_set(&allocated->metadata, "comment", comment.c_str(), 0);
        check(avio_open(&allocated->pb, file_url(temporary_).c_str(), AVIO_FLAG_WRITE), "create the file");
        AVDictionary* options = nullptr;
        av_dict_set(&options, "movflags", "+faststart", 0);
        const int written = avformat_write_header(allocated, &options);
        av_dict_free(&options);
        check(written, "write the header");
    }

    // The sound before it is written first, so that a player finds both in the same place.
    void copy_image() {
        if (packet_->dts != AV_NOPTS_VALUE) encode_until(static_cast<double>(packet_->dts) * av_q2d(from_->time_base));
        av_packet_rescale_ts(packet_.get(), from_->time_base, images_->time_base);
        packet_->stream_index = images_->index;
        packet_->pos = -1;
        check(av_interleaved_write_frame(output_.get(), packet_.get()), "write an image");
    }
    void encode_until(double time_s) {
        while (static_cast<double>(next_sample_) < std::min(time_s, length_s()) * kSoundRate) {
            check(av_frame_make_writable(frame_.get()), "have memory for a sound");
            next_(samples_);
            for (size_t side = 0; side < 2; side++) {
                auto* to = reinterpret_cast<float*>(frame_->extended_data[side]);
                for (size_t i = 0; i < kSoundHop; i++) to[i] = std::clamp(samples_[i][side], -1.0f, 1.0f);
            }
            frame_->pts = next_sample_;
            next_sample_ += kSoundHop;
            encode(frame_.get());
        }
    }
    // Null: what the encoder holds back.
    void encode(const AVFrame* frame) {
        check(avcodec_send_frame(encoder_.get(), frame), "encode the sound");
        for (int code = 0; (code = avcodec_receive_packet(encoder_.get(), coded_.get())) != AVERROR_EOF;) {
            if (code == AVERROR(EAGAIN)) return;
            check(code, "encode the sound");
            av_packet_rescale_ts(coded_.get(), encoder_->time_base, sound_->time_base);
            coded_->stream_index = sound_->index;
            check(av_interleaved_write_frame(output_.get(), coded_.get()), "write the sound");
        }
    }

    std::filesystem::path path_, temporary_;
    const NextSamples& next_;
    std::array<StereoSample, kSoundHop> samples_{};
    OwnedInput input_;
    OwnedOutput output_;
    OwnedCodec encoder_;
    OwnedFrame frame_;
    OwnedPacket packet_, coded_;
    const AVStream* from_ = nullptr;                 // owned by input_
    AVStream *images_ = nullptr, *sound_ = nullptr;  // owned by output_
    int64_t next_sample_ = 0;
};

}  // namespace

void add_sound(const std::filesystem::path& video, const NextSamples& next) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    VideoWithSound(video, next).write();
}

}  // namespace neuvv::media
