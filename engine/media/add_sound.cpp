#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "media/mp4_file.h"
#include "media/sound.h"
#include "media/video.h"

namespace neuvv::media {

namespace {

constexpr int64_t kBitRate = 192'000;

void free_parameters(AVCodecParameters* parameters) {
    avcodec_parameters_free(&parameters);
}

// A video that is copied, with a track beside it.
class VideoWithSound {
  public:
    VideoWithSound(const std::filesystem::path& video, const NextSamples& next)
        : file_(video, ".sound.mp4"), next_(next) {}

    void write() {
        open_input();
        open_encoder();
        open_output();
        for (int read = 0; (read = av_read_frame(input_.get(), packet_.get())) != AVERROR_EOF;) {
            if (read < 0) fail("cannot be read to its end");
            if (packet_->stream_index == from_->index) copy_image();
            av_packet_unref(packet_.get());
        }
        encode_until(length_s());
        encode(nullptr);
        file_.finish();
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(file_.path().string(), "", problem, "render the video again");
    }
    double length_s() const { return static_cast<double>(from_->nb_frames) / av_q2d(from_->avg_frame_rate); }

    void open_input() {
        AVFormatContext* opened = nullptr;
        if (open_video_file(file_.path(), &opened) < 0) fail("cannot be opened as a video");
        input_.reset(opened);
        from_ = video_of(opened);
        if (!from_) fail("has no video");
        if (from_->nb_frames <= 0 || from_->avg_frame_rate.num <= 0 || from_->avg_frame_rate.den <= 0)
            fail("does not say how many images it has");
    }
    void open_encoder() {
        expect_sound_encoder();
        const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_AAC);
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
        file_.check(avcodec_open2(encoder_.get(), codec, nullptr), "open the AAC encoder");
        if (encoder_->frame_size != static_cast<int>(kSoundHop))
            throw RuntimeFailure("the installed FFmpeg's AAC encoder has another frame size than 1024");
        frame_->format = encoder_->sample_fmt;
        frame_->nb_samples = encoder_->frame_size;
        frame_->sample_rate = kSoundRate;
        file_.check(av_channel_layout_copy(&frame_->ch_layout, &encoder_->ch_layout), "describe the sound");
        file_.check(av_frame_get_buffer(frame_.get(), 0), "have memory for a sound");
    }
    void open_output() {
        file_.open();
        images_ = file_.add_stream(*from_->codecpar, from_->time_base);
        images_->avg_frame_rate = from_->avg_frame_rate;
        const std::unique_ptr<AVCodecParameters, Release<free_parameters>> sound(avcodec_parameters_alloc());
        if (!sound) throw std::bad_alloc();
        file_.check(avcodec_parameters_from_context(sound.get(), encoder_.get()), "describe the sound");
        sound_ = file_.add_stream(*sound, encoder_->time_base);
        file_.begin(comment_of_video(file_.path()));
    }

    // The sound before it is written first, so that a player finds both in the same place.
    void copy_image() {
        if (packet_->dts != AV_NOPTS_VALUE) encode_until(static_cast<double>(packet_->dts) * av_q2d(from_->time_base));
        av_packet_rescale_ts(packet_.get(), from_->time_base, images_->time_base);
        packet_->stream_index = images_->index;
        packet_->pos = -1;
        file_.write(packet_.get());
    }
    void encode_until(double time_s) {
        while (static_cast<double>(next_sample_) < std::min(time_s, length_s()) * kSoundRate) {
            file_.check(av_frame_make_writable(frame_.get()), "have memory for a sound");
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
        file_.check(avcodec_send_frame(encoder_.get(), frame), "encode the sound");
        for (int code = 0; (code = avcodec_receive_packet(encoder_.get(), coded_.get())) != AVERROR_EOF;) {
            if (code == AVERROR(EAGAIN)) return;
            file_.check(code, "encode the sound");
            av_packet_rescale_ts(coded_.get(), encoder_->time_base, sound_->time_base);
            coded_->stream_index = sound_->index;
            file_.write(coded_.get());
        }
    }

    Mp4File file_;
    const NextSamples& next_;
    std::array<StereoSample, kSoundHop> samples_{};
    OwnedInput input_;
    OwnedCodec encoder_;
    OwnedFrame frame_;
    OwnedPacket packet_, coded_;
    const AVStream* from_ = nullptr;                 // owned by input_
    AVStream *images_ = nullptr, *sound_ = nullptr;  // owned by file_
    int64_t next_sample_ = 0;
};

}  // namespace

void expect_sound_encoder() {
    if (!avcodec_find_encoder(AV_CODEC_ID_AAC)) throw RuntimeFailure("the installed FFmpeg has no AAC encoder");
}

void add_sound(const std::filesystem::path& video, const NextSamples& next) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    VideoWithSound(video, next).write();
}

}  // namespace neuvv::media
