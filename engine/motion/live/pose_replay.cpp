#include "motion/live/pose_replay.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/skeleton/words.h"

namespace neuvv::motion {

namespace {

class PoseReplay : public PoseSource {
  public:
    explicit PoseReplay(const std::filesystem::path& file) : name_(file.string()) {
        if (lower_case(file.extension().string()) == ".jsonl")
            read_lines(file);
        else
            read_clip(read_skeleton(file));
    }

    std::optional<TimedPose> newest(double now_s) override {
        if (!begin_s_) begin_s_ = now_s;
        const double from_file_s = *begin_s_ - poses_.front().time_s;
        const size_t before = next_;
        while (next_ < poses_.size() && poses_[next_].time_s + from_file_s <= now_s) ++next_;
        if (next_ == before) return std::nullopt;
        state_.poses += next_ - before;
        state_.stopped = next_ == poses_.size();
        return TimedPose{poses_[next_ - 1].time_s + from_file_s, poses_[next_ - 1].pose};
    }
    void rewind(double now_s, double to_s) override {
        begin_s_ = now_s - to_s;
        next_ = 0;
        state_.stopped = false;
    }
    bool is_recorded() const override { return true; }
    PoseSourceState state() const override { return state_; }
    std::string name() const override { return name_; }

  private:
    void read_lines(const std::filesystem::path& file) {
        Words words(file);
        FirstPerson person;
        std::string line;
        for (size_t number = 1; words.line(line); ++number) {
            if (line.empty()) continue;
            try {
                const std::string place = fmt::format("{}: line {}", name_, number);
                const TimedPose pose = read_pose_line(line, place);
                person.expect(pose, place);
                add(pose, number);
            } catch (const InputError& error) {
                if (state_.left_out++ == 0) state_.first_error = error.what();
            }
        }
        if (poses_.empty())
            throw InputError(name_, "", "has no pose", "write one pose a line, as engine/motion/README.md says");
    }

    void add(const TimedPose& pose, size_t line) {
        const std::string place = fmt::format("line {}", line);
        if (!poses_.empty() && !(pose.time_s > poses_.back().time_s))
            throw InputError(name_, place, "has a time that is not after that of the pose before it");
        if (poses_.size() == kMaxSkeletonFrames)
            throw InputError(name_, place, fmt::format("is beyond {} poses", kMaxSkeletonFrames), "cut the file");
        poses_.push_back(pose);
    }

    void read_clip(const SkeletonClip& clip) {
        for (size_t f = 0; f < clip.frames.size(); ++f)
            poses_.push_back({static_cast<double>(f) / clip.fps, clip.frames[f]});
    }

    std::string name_;
    std::vector<TimedPose> poses_;
    PoseSourceState state_;
    size_t next_ = 0;                // the pose that is due next
    std::optional<double> begin_s_;  // when the first pose was shown
};

}  // namespace

std::unique_ptr<PoseSource> replay_poses(const std::filesystem::path& file) {
    return std::make_unique<PoseReplay>(file);
}

}  // namespace neuvv::motion
