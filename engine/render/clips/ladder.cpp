#include "render/clips/ladder.h"

namespace neuvv::render {

void Ladder::Mean::add(double count, double seconds) {
    constexpr double kOlder = 0.9;  // what was added before counts after this
    count_ = kOlder * count_ + count;
    seconds_ = kOlder * seconds_ + seconds;
}

void Ladder::learn_planes(uint64_t bytes, double seconds) {
    planes_.add(static_cast<double>(bytes), seconds);
}

void Ladder::learn_step(FrameStep step, double seconds) {
    steps_[static_cast<size_t>(step)].add(1, seconds);
}

stream::Part Ladder::choose(const stream::GroupCost& group, std::optional<double> bytes_per_s) const {
    double steps_s = 0;
    for (const Mean& step : steps_) steps_s += group.frames * step.value();
    const auto comes_in_time = [&](stream::Part last) {
        const auto bytes = static_cast<double>(group.bytes_until[last]);
        const double until_s = kShare * group.seconds;
        return (!bytes_per_s || bytes <= *bytes_per_s * until_s) &&
               steps_s + bytes * planes_.value() <= frames_at_once_ * until_s;
    };
    for (const stream::Part last : {stream::kShFine, stream::kFine, stream::kShCoarse})
        if (comes_in_time(last)) return last;
    return stream::kCoarse;
}

}  // namespace neuvv::render
