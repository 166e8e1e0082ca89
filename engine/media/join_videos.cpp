#include <fmt/format.h>

#include <cstring>

#include "base/error.h"
#include "media/mp4_file.h"
#include "media/video.h"

namespace neuvv::media {

namespace {

constexpr const char* kComment = "comment";  // libav's name of it

// A part, opened at its first packet.
struct Part {
    std::filesystem::path path;
    OwnedInput input;
    const AVStream* stream = nullptr;  // owned by input

    [[noreturn]] void fail(const std::string& problem,
                           const char* fix = "remove it, and render this part again") const {
        throw InputError(path.string(), "", problem, fix);
    }
};

Part open_part(const std::filesystem::path& path) {
    Part part{path, nullptr, nullptr};
    AVFormatContext* opened = nullptr;
    if (open_video_file(path, &opened) < 0) part.fail("cannot be opened as a video");
    part.input.reset(opened);
    part.stream = video_of(opened);
    if (!part.stream) part.fail("has no video");
    if (part.stream->avg_frame_rate.num <= 0 || part.stream->avg_frame_rate.den <= 0) part.fail("has no frame rate");
    return part;
}

// Whether a decoder of `a` also decodes `b`.
bool is_alike(const AVCodecParameters& a, const AVCodecParameters& b) {
    return a.codec_id == b.codec_id && a.width == b.width && a.height == b.height && a.format == b.format &&
           a.extradata_size == b.extradata_size &&
           (a.extradata_size == 0 || std::memcmp(a.extradata, b.extradata, static_cast<size_t>(a.extradata_size)) == 0);
}

class JoinedVideo {
  public:
    explicit JoinedVideo(const std::filesystem::path& path) : file_(path) {}

    // Before the first append(): the video is encoded as `first`.
    void open(const Part& first, const std::string& comment);
    void append(const Part& part);
    void finish() { file_.finish(); }

  private:
    Mp4File file_;
    OwnedPacket packet_;
    AVStream* stream_ = nullptr;  // owned by file_
    int64_t frames_ = 0;
};

void JoinedVideo::open(const Part& first, const std::string& comment) {
    packet_.reset(av_packet_alloc());
    if (!packet_) throw std::bad_alloc();
    file_.open();
    stream_ = file_.add_stream(*first.stream->codecpar, first.stream->time_base);
    stream_->avg_frame_rate = first.stream->avg_frame_rate;
    file_.begin(comment);
}

// Each part's times begin at 0 again, so the frames before it are added to them. The times at which frames are decoded
// run evenly over all parts, as far before their display as the codec reorders frames.
void JoinedVideo::append(const Part& part) {
    const AVRational frame = av_inv_q(part.stream->avg_frame_rate);
    const auto time_of = [&](int64_t frames) { return av_rescale_q(frames, frame, stream_->time_base); };
    int64_t count = 0;
    for (int read = 0; (read = av_read_frame(part.input.get(), packet_.get())) != AVERROR_EOF;
         av_packet_unref(packet_.get())) {
        if (read < 0) part.fail(fmt::format("cannot be read: {}", error_text(read)));
        if (packet_->stream_index != part.stream->index) continue;
        if (packet_->flags & AV_PKT_FLAG_CORRUPT) part.fail("was cut short");
        av_packet_rescale_ts(packet_.get(), part.stream->time_base, stream_->time_base);
        if (packet_->pts < 0 || packet_->pts > time_of(part.stream->nb_frames))  // also where there is no time
            part.fail("has a frame at a wrong time");
        packet_->pts += time_of(frames_);
        packet_->dts = time_of(frames_ + count - part.stream->codecpar->video_delay);
        packet_->duration = time_of(1);
        packet_->stream_index = stream_->index;
        packet_->pos = -1;
        ++count;
        file_.write(packet_.get());
    }
    if (count == 0 || count < part.stream->nb_frames)
        part.fail(fmt::format("holds {} of {} frames", count, part.stream->nb_frames));
    frames_ += count;
}

}  // namespace

void join_videos(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& path,
                 const std::string& comment) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    const Part first = open_part(parts.at(0));
    JoinedVideo joined(path);
    joined.open(first, comment);
    for (const std::filesystem::path& file : parts) {
        const Part part = open_part(file);
        if (!is_alike(*part.stream->codecpar, *first.stream->codecpar) ||
            av_cmp_q(part.stream->avg_frame_rate, first.stream->avg_frame_rate) != 0)
            part.fail(fmt::format("is of another size, rate or encoder than {}", parts[0].string()),
                      "render all parts by the same program with the same FFmpeg");
        joined.append(part);
    }
    joined.finish();
}

std::string comment_of_video(const std::filesystem::path& path) {
    av_log_set_level(AV_LOG_QUIET);  // only tools print
    AVFormatContext* opened = nullptr;
    if (open_video_file(path, &opened) < 0) return {};
    const OwnedInput input(opened);
    const AVDictionaryEntry* entry = av_dict_get(opened->metadata, kComment, nullptr, 0);
    return entry ? entry->value : "";
}

}  // namespace neuvv::media
