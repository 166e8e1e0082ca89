#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "media/sound_track.h"
#include "media/video.h"

namespace neuvv::media {

namespace {

// A video that is copied, with a track beside it.
class VideoWithSound {
  public:
    VideoWithSound(const std::filesystem::path& video, const NextSamples& next) : file_(video), sound_(file_, next) {}

    void write() {
        open_input();
        open_output();
        for (int read = 0; (read = av_read_frame(input_.get(), packet_.get())) != AVERROR_EOF;) {
            if (read < 0) fail("cannot be read to its end");
            if (packet_->stream_index == from_->index) copy_image();
            av_packet_unref(packet_.get());
        }
        sound_.encode_until(length_s());
        sound_.end();
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
        packet_.reset(av_packet_alloc());
        if (!packet_) throw std::bad_alloc();
        from_ = video_of(opened);
        if (!from_) fail("has no video");
        if (from_->nb_frames <= 0 || from_->avg_frame_rate.num <= 0 || from_->avg_frame_rate.den <= 0)
            fail("does not say how many images it has");
    }
    void open_output() {
        file_.open();
        images_ = file_.add_stream(*from_->codecpar, from_->time_base);
        images_->avg_frame_rate = from_->avg_frame_rate;
        sound_.add();
        file_.begin(comment_of_video(file_.path()));
    }

    // The sound before it is written first, so that a player finds both in the same place.
    void copy_image() {
        if (packet_->dts != AV_NOPTS_VALUE)
            sound_.encode_until(std::min(static_cast<double>(packet_->dts) * av_q2d(from_->time_base), length_s()));
        av_packet_rescale_ts(packet_.get(), from_->time_base, images_->time_base);
        packet_->stream_index = images_->index;
        packet_->pos = -1;
        file_.write(packet_.get());
    }

    Mp4File file_;
    SoundTrack sound_;
    OwnedInput input_;
    OwnedPacket packet_;
    const AVStream* from_ = nullptr;  // owned by input_
    AVStream* images_ = nullptr;      // owned by file_
};

}  // namespace

void expect_sound_encoder() {
    if (!avcodec_find_encoder(AV_CODEC_ID_AAC)) throw RuntimeFailure("the installed FFmpeg has no AAC encoder");
}

void add_sound(const std::filesystem::path& video, const NextSamples& next) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    VideoWithSound(video, next).write();
}

void write_sound(const std::filesystem::path& path, const Sound& sound) {
    av_log_set_level(AV_LOG_QUIET);
    size_t at = 0;
    const NextSamples next = [&](std::array<StereoSample, kSoundHop>& samples) {
        for (StereoSample& sample : samples) {
            const bool is_there = at < sound.samples.size();
            for (size_t side = 0; side < 2; ++side)
                sample[side] = is_there ? static_cast<float>(sound.samples[at][side]) / 32768 : 0;
            ++at;
        }
    };
    Mp4File file(path);
    SoundTrack track(file, next);
    file.open();
    track.add();
    file.begin("");
    track.encode_until(sound.length_s());
    track.end();
    file.finish();
}

}  // namespace neuvv::media
