// A track of sound that is encoded into an .mp4.
#pragma once

#include <algorithm>
#include <memory>

#include "media/mp4_file.h"
#include "media/sound.h"

namespace neuvv::media {

// The file must outlive it. All functions throw RuntimeFailure.
class SoundTrack {
  public:
    SoundTrack(Mp4File& file, const NextSamples& next) : file_(file), next_(next) { open_encoder(); }

    // Adds the track to the open file, before it begins.
    void add() {
        const std::unique_ptr<AVCodecParameters, Release<free_parameters>> sound(avcodec_parameters_alloc());
        if (!sound) throw std::bad_alloc();
        file_.check(avcodec_parameters_from_context(sound.get(), encoder_.get()), "describe the sound");
        sound_ = file_.add_stream(*sound, encoder_->time_base);
    }
    // Encodes up to this time, in seconds.
    void encode_until(double time_s) {
        while (static_cast<double>(next_sample_) < time_s * kSoundRate) {
            file_.check(av_frame_make_writable(frame_.get()), "have memory for a sound");
            next_(samples_);
            for (size_t side = 0; side < 2; ++side) {
                auto* to = reinterpret_cast<float*>(frame_->extended_data[side]);
                for (size_t i = 0; i < kSoundHop; ++i) to[i] = std::clamp(samples_[i][side], -1.0f, 1.0f);
            }
            frame_->pts = next_sample_;
            next_sample_ += kSoundHop;
            encode(frame_.get());
        }
    }
    // Encodes what the encoder holds back.
    void end() { encode(nullptr); }

  private:
    static constexpr int64_t kBitRate = 192'000;
    static void free_parameters(AVCodecParameters* parameters) { avcodec_parameters_free(&parameters); }

    void open_encoder() {
        expect_sound_encoder();
        const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_AAC);
        encoder_.reset(avcodec_alloc_context3(codec));
        coded_.reset(av_packet_alloc());
        frame_.reset(av_frame_alloc());
        if (!encoder_ || !coded_ || !frame_) throw std::bad_alloc();
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

    Mp4File& file_;
    const NextSamples& next_;
    std::array<StereoSample, kSoundHop> samples_{};
    OwnedCodec encoder_;
    OwnedFrame frame_;
    OwnedPacket coded_;
    AVStream* sound_ = nullptr;  // owned by file_
    int64_t next_sample_ = 0;
};

}  // namespace neuvv::media
