#include <fmt/format.h>

#include "base/error.h"
#include "media/libav.h"
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

class SoundReader {
  public:
    explicit SoundReader(const std::filesystem::path& path) : path_(path) {
        AVDictionary* options = nullptr;
        av_dict_set(&options, "protocol_whitelist", "file", 0);
        av_dict_set(&options, "format_whitelist", kFormats, 0);
        AVFormatContext* opened = nullptr;
        const int code = avformat_open_input(&opened, file_url(path).c_str(), nullptr, &options);
        av_dict_free(&options);
        if (code < 0) fail("cannot be opened as a sound");
        input_.reset(opened);
        const AVCodec* codec = nullptr;
        if (avformat_find_stream_info(opened, nullptr) >= 0)
            index_ = av_find_best_stream(opened, AVMEDIA_TYPE_AUDIO, -1, -1, &codec, 0);
        if (index_ < 0 || !codec) fail("has no sound that can be decoded");
        decoder_.reset(avcodec_alloc_context3(codec));
        packet_.reset(av_packet_alloc());
        frame_.reset(av_frame_alloc());
        if (!decoder_ || !packet_ || !frame_) throw std::bad_alloc();
        if (avcodec_parameters_to_context(decoder_.get(), opened->streams[index_]->codecpar) < 0 ||
            avcodec_open2(decoder_.get(), codec, nullptr) < 0)
            fail("has a sound that cannot be decoded");
    }

    Sound read() {
        while (av_read_frame(input_.get(), packet_.get()) >= 0) {
            if (packet_->stream_index == index_) decode(packet_.get());
            av_packet_unref(packet_.get());
        }
        decode(nullptr);
        convert(nullptr);
        if (sound_.samples.empty()) fail("has a sound without samples");
        return std::move(sound_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(path_.string(), "", problem, "give a .wav, .flac, .ogg, .mp3 or .m4a, or a video with sound");
    }
    // A damaged packet is left out, as players do; null: what the decoder holds back.
    void decode(const AVPacket* packet) {
        if (avcodec_send_packet(decoder_.get(), packet) < 0) return;
        while (avcodec_receive_frame(decoder_.get(), frame_.get()) >= 0) {
            convert(frame_.get());
            av_frame_unref(frame_.get());
        }
    }
    // Null: what the converter holds back.
    void convert(const AVFrame* frame) {
        if (frame && !converter_) open_converter(*frame);
        if (!converter_) return;
        const int given = frame ? frame->nb_samples : 0;
        const int room = swr_get_out_samples(converter_.get(), given);
        if (room < 0) fail("has a sound that cannot be converted");
        const size_t before = sound_.samples.size();
        if (static_cast<double>(before + static_cast<size_t>(room)) > kMaxSound_s * kSoundRate)
            fail(fmt::format("has a sound of more than {} hours", kMaxSound_s / 3600));
        sound_.samples.resize(before + static_cast<size_t>(room));
        auto* to = reinterpret_cast<uint8_t*>(sound_.samples.data() + before);
        const int made = swr_convert(converter_.get(), &to, room,
                                     frame ? const_cast<const uint8_t**>(frame->extended_data) : nullptr, given);
        if (made < 0) fail("changes its form on the way");
        sound_.samples.resize(before + static_cast<size_t>(made));
    }
    void open_converter(const AVFrame& frame) {
        AVChannelLayout from{};
        if (frame.ch_layout.order == AV_CHANNEL_ORDER_UNSPEC)
            av_channel_layout_default(&from, frame.ch_layout.nb_channels);
        else if (av_channel_layout_copy(&from, &frame.ch_layout) < 0)
            throw std::bad_alloc();
        AVChannelLayout stereo = AV_CHANNEL_LAYOUT_STEREO;
        SwrContext* opened = nullptr;
        const int code = swr_alloc_set_opts2(&opened, &stereo, AV_SAMPLE_FMT_S16, kSoundRate, &from,
                                             static_cast<AVSampleFormat>(frame.format), frame.sample_rate, 0, nullptr);
        av_channel_layout_uninit(&from);
        converter_.reset(opened);
        if (code < 0 || swr_init(opened) < 0) fail("has a sound that cannot be converted");
    }

    std::filesystem::path path_;
    OwnedInput input_;
    OwnedCodec decoder_;
    OwnedPacket packet_;
    OwnedFrame frame_;
    OwnedConverter converter_;
    int index_ = -1;
    Sound sound_;
};

}  // namespace

Sound read_sound(const std::filesystem::path& path) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    return SoundReader(path).read();
}

}  // namespace neuvv::media
