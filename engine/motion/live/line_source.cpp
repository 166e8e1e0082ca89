#include "motion/live/line_source.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/line_reader.h"
#include "motion/live/pose_stream.h"

namespace neuvv::motion {

namespace {

// What a call reads at most, about twice of what a pipe holds.
constexpr size_t kMostLines = 512, kMostLine_bytes = 1 << 17;

class LineSource : public PoseSource {
  public:
    LineSource(int descriptor, std::string name) : reader_(descriptor, kLongestPoseLine), name_(std::move(name)) {}

    std::optional<TimedPose> newest(double now_s) override {
        size_t bytes = 0;
        for (size_t i = 0; i < kMostLines && bytes <= kMostLine_bytes; ++i) {
            const LineReader::Result result = reader_.next(line_);
            if (result == LineReader::Result::kEnd) stream_.end();
            if (result != LineReader::Result::kLine) break;
            bytes += line_.size();
            add_line(now_s);
        }
        return stream_.take(now_s);
    }
    PoseSourceState state() const override { return stream_.state(); }
    std::string name() const override { return name_; }

  private:
    void add_line(double now_s) {
        ++number_;
        if (line_.empty()) return;
        try {
            const std::string place = fmt::format("{}: line {}", name_, number_);
            const TimedPose pose = read_pose_line(line_, place);
            person_.expect(pose, place);
            stream_.add(pose, now_s);
        } catch (const InputError& error) {
            stream_.leave_out(error.what());
        }
    }

    LineReader reader_;
    PoseStream stream_;
    FirstPerson person_;
    std::string name_, line_;
    uint64_t number_ = 0;  // of the last line
};

}  // namespace

std::unique_ptr<PoseSource> read_lines_of_poses(int descriptor, const std::string& name) {
    return std::make_unique<LineSource>(descriptor, name);
}

}  // namespace neuvv::motion
