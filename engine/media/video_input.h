// A file that is opened as a video.
#pragma once

#include <fmt/format.h>

#include "base/error.h"
#include "media/libav.h"

namespace neuvv::media {

class VideoInput {
  public:
    // Throws InputError.
    explicit VideoInput(const std::filesystem::path& path) : path_(path) {
        av_log_set_level(AV_LOG_QUIET);  // only tools print
        AVFormatContext* opened = nullptr;
        if (const int code = open_video_file(path, &opened); code < 0)
            throw InputError(path.string(), "", fmt::format("cannot open as a video: {}", error_text(code)),
                             code == AVERROR(ENOENT) ? "check the path" : "give a video that FFmpeg can read");
        context_.reset(opened);
        check(avformat_find_stream_info(opened, nullptr), "cannot find its streams");
        index_ = av_find_best_stream(opened, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder_, 0);
        check(index_, "no video stream");
        packet_.reset(av_packet_alloc());
        if (!packet_) throw std::bad_alloc();
        expect_possible_count();
    }

    const AVFormatContext& context() const { return *context_; }
    const AVStream& stream() const { return *context_->streams[index_]; }
    const AVCodec* decoder() const { return decoder_; }
    const std::filesystem::path& path() const { return path_; }

    // The entries of the file's index that are frames, in order of decoding; empty where it has no index of all.
    std::vector<const AVIndexEntry*> frames() const {
        std::vector<const AVIndexEntry*> entries;
        AVStream* stream = context_->streams[index_];
        for (int i = 0; stream->nb_frames > 0 && i < avformat_index_get_entries_count(stream); ++i)
            if (const AVIndexEntry* entry = avformat_index_get_entry(stream, i); entry->size > 0)
                entries.push_back(entry);
        return entries;
    }
    // The next packet of the video, which is valid until the next call; null at the end. Throws InputError.
    AVPacket* read() {
        for (;;) {
            av_packet_unref(packet_.get());
            const int read = av_read_frame(context_.get(), packet_.get());
            if (read == AVERROR_EOF) return nullptr;
            check(read, "cannot read");
            if (packet_->stream_index == index_) return packet_.get();
        }
    }

    [[noreturn]] void fail(const std::string& problem) const { throw InputError(path_.string(), "", problem); }
    void check(int code, const char* what) const {
        if (code < 0) fail(fmt::format("{}: {}", what, error_text(code)));
    }

  private:
    void expect_possible_count() const {
        std::error_code ignored;
        const auto bytes = static_cast<int64_t>(std::filesystem::file_size(path_, ignored));
        if (stream().nb_frames > bytes) fail(fmt::format("claims {} frames in {} bytes", stream().nb_frames, bytes));
    }

    std::filesystem::path path_;
    OwnedInput context_;
    OwnedPacket packet_;
    const AVCodec* decoder_ = nullptr;
    int index_ = 0;  // of the video stream
};

// Whether a packet or an index entry is a frame that is shown: an edit list cuts off others, of which some are decoded
// because frames that are shown need them.
inline bool is_shown(const AVPacket& packet) {
    return packet.size > 0 && !(packet.flags & AV_PKT_FLAG_DISCARD);
}
inline bool is_shown(const AVIndexEntry& entry) {
    return !(entry.flags & AVINDEX_DISCARD_FRAME);
}

}  // namespace neuvv::media
