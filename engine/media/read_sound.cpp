#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "media/libav.h"
#include "media/memory_input.h"
#include "media/sound.h"

extern "C" {
#include <libswresample/swresample.h>
}

namespace neuvv::media {

namespace {

void free_converter(SwrContext* converter) {
    swr_free(&converter);
}
using OwnedConverter = Owned<SwrContext, free_converter>;

constexpr const char* kFormats = "wav,flac,ogg,mp3,aac,mov,mp4,matroska,avi";
constexpr int kLeastRate = 4000, kMostRate = 768'000, kMostChannels = 64;
constexpr double kGap_s = 0.03;  // a frame that comes later than this begins after a silence
constexpr size_t kSilenceAtATime = kSoundRate;

class SoundReader {
  public:
    SoundReader(const SoundFile& file, const TakeSamples& take) : path_(file.path), take_(take) {
        open(file);
        AVFormatContext* opened = input_.get();
        const AVCodec* codec = nullptr;
        int index = -1;
        if (avformat_find_stream_info(opened, nullptr) >= 0)
            index = av_find_best_stream(opened, AVMEDIA_TYPE_AUDIO, -1, -1, &codec, 0);
        if (index < 0 || !codec) fail("has no sound that can be decoded");
        stream_ = opened->streams[index];
        decoder_.reset(avcodec_alloc_context3(codec));
        packet_.reset(av_packet_alloc());
        frame_.reset(av_frame_alloc());
        if (!decoder_ || !packet_ || !frame_) throw std::bad_alloc();
        if (avcodec_parameters_to_context(decoder_.get(), stream_->codecpar) < 0 ||
            avcodec_open2(decoder_.get(), codec, nullptr) < 0)
            fail("has a sound that cannot be decoded");
        decoder_->pkt_timebase = stream_->time_base;
    }

    void read() {
        int code = 0;
        while (!stopped_ && (code = av_read_frame(input_.get(), packet_.get())) >= 0) {
            if (packet_->stream_index == stream_->index) decode(packet_.get());
            av_packet_unref(packet_.get());
        }
        if (stopped_) return;
        if (code != AVERROR_EOF) fail("cannot be read to its end");
        decode(nullptr);
        drain();
        if (samples_read_ == 0) fail("has a sound without samples");
    }

  private:
    // So that the file cannot make FFmpeg open others or the network.
    void open(const SoundFile& file) {
        AVFormatContext* opened = nullptr;
        if (file.bytes) {
            memory_.emplace(*file.bytes);
            opened = avformat_alloc_context();
            if (!opened) throw std::bad_alloc();
            opened->pb = memory_->context();
        }
        if (!file.bytes) expect_regular_file(path_);
        AVDictionary* options = nullptr;
        av_dict_set(&options, "protocol_whitelist", file.bytes ? "none" : "file", 0);
        av_dict_set(&options, "format_whitelist", kFormats, 0);
        const std::string url = file.bytes ? std::string() : file_url(path_);
        const int code = avformat_open_input(&opened, url.c_str(), nullptr, &options);  // where it fails, it frees
        av_dict_free(&options);
        if (code < 0) fail("cannot be opened as a sound");
        input_.reset(opened);
    }

    // What the converter was opened for.
    struct Form {
        int format = -1, rate = 0, channels = 0;
        bool operator==(const Form&) const = default;
    };

    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(path_.string(), "", problem, "give a .wav, .flac, .ogg, .mp3 or .m4a, or a video with sound");
    }
    // A damaged packet is left out: what comes after it is where it belongs. Null: what the decoder holds back.
    void decode(const AVPacket* packet) {
        if (avcodec_send_packet(decoder_.get(), packet) < 0) return;
        while (avcodec_receive_frame(decoder_.get(), frame_.get()) >= 0) {
            take_frame();
            av_frame_unref(frame_.get());
        }
    }
    void take_frame() {
        const Form form{frame_->format, frame_->sample_rate, frame_->ch_layout.nb_channels};
        if (form.rate < kLeastRate || form.rate > kMostRate || form.channels < 1 || form.channels > kMostChannels)
            fail(fmt::format("has a sound of {} channels at {} Hz", form.channels, form.rate));
        if (form != form_) {  // also of files that were put behind each other
            drain();
            open_converter();
            form_ = form;
        }
        fill_gap();
        convert(const_cast<const uint8_t**>(frame_->extended_data), frame_->nb_samples);
    }
    // A track may begin later than its file, and have gaps.
    void fill_gap() {
        if (frame_->best_effort_timestamp == AV_NOPTS_VALUE) return;
        const double begin_s = input_->start_time == AV_NOPTS_VALUE ? 0 : double(input_->start_time) / AV_TIME_BASE;
        const double at_s = static_cast<double>(frame_->best_effort_timestamp) * av_q2d(stream_->time_base) - begin_s;
        const double held_s = static_cast<double>(swr_get_delay(converter_.get(), kSoundRate)) / kSoundRate;
        const double gap_s = at_s - held_s - static_cast<double>(samples_read_) / kSoundRate;
        if (!(gap_s > kGap_s)) return;
        drain();
        open_converter();  // which drained gives nothing more
        give_silence(static_cast<size_t>(std::min(gap_s, 2 * kMaxSound_s) * kSoundRate));
    }
    void expect_room_for(size_t samples) const {
        if (static_cast<double>(samples_read_ + samples) > kMaxSound_s * kSoundRate)
            fail(fmt::format("has a sound of more than {} hours", kMaxSound_s / 3600));
    }
    void give(std::span<const StereoSample16> samples) {
        if (stopped_ || samples.empty()) return;
        samples_read_ += samples.size();
        stopped_ = !take_(samples);
    }
    void give_silence(size_t samples) {
        expect_room_for(samples);
        converted_.assign(std::min(samples, kSilenceAtATime), {});
        for (size_t left = samples; left > 0 && !stopped_; left -= std::min(left, kSilenceAtATime))
            give(std::span(converted_).first(std::min(left, kSilenceAtATime)));
    }
    // What the converter holds back.
    void drain() {
        if (converter_) convert(nullptr, 0);
    }
    void convert(const uint8_t** from, int count) {
        const int room = swr_get_out_samples(converter_.get(), count);
        if (room < 0) fail("has a sound that cannot be converted");
        expect_room_for(static_cast<size_t>(room));
        converted_.resize(static_cast<size_t>(room));
        auto* to = reinterpret_cast<uint8_t*>(converted_.data());
        const int made = swr_convert(converter_.get(), &to, room, from, count);
        if (made < 0) fail("has a sound that cannot be converted");
        give(std::span(converted_).first(static_cast<size_t>(made)));
    }
    void open_converter() {
        AVChannelLayout from{};
        if (frame_->ch_layout.order == AV_CHANNEL_ORDER_UNSPEC)
            av_channel_layout_default(&from, frame_->ch_layout.nb_channels);
        else if (av_channel_layout_copy(&from, &frame_->ch_layout) < 0)
            throw std::bad_alloc();
        AVChannelLayout stereo = AV_CHANNEL_LAYOUT_STEREO;
        SwrContext* opened = nullptr;
        const int code =
            swr_alloc_set_opts2(&opened, &stereo, AV_SAMPLE_FMT_S16, kSoundRate, &from,
                                static_cast<AVSampleFormat>(frame_->format), frame_->sample_rate, 0, nullptr);
        av_channel_layout_uninit(&from);
        converter_.reset(opened);
        if (code < 0 || swr_init(opened) < 0) fail("has a sound that cannot be converted");
    }

    std::filesystem::path path_;
    std::optional<MemoryInput> memory_;  // of a file whose content is given; input_ reads from it
    OwnedInput input_;
    OwnedCodec decoder_;
    OwnedPacket packet_;
    OwnedFrame frame_;
    OwnedConverter converter_;
    Form form_;
    const AVStream* stream_ = nullptr;  // owned by input_
    const TakeSamples& take_;
    std::vector<StereoSample16> converted_;  // by the last call, kept for its memory
    size_t samples_read_ = 0;                // that `take_` has got
    bool stopped_ = false;                   // `take_` wants no more
};

}  // namespace

void decode_sound(const SoundFile& file, const TakeSamples& take) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    SoundReader(file, take).read();
}

Sound read_sound(const SoundFile& file) {
    Sound sound;
    decode_sound(file, [&](std::span<const StereoSample16> samples) {
        sound.samples.insert(sound.samples.end(), samples.begin(), samples.end());
        return true;
    });
    return sound;
}

}  // namespace neuvv::media
