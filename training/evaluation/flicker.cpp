#include "training/evaluation/flicker.h"

#include <algorithm>
#include <cstdlib>

namespace neuvv::training {

namespace {

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto centre = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), centre, values.end());
    return *centre;
}

FlickerLevels medians(const std::vector<FlickerLevels>& levels) {
    std::vector<double> still, moving;
    for (const FlickerLevels& one : levels) {
        still.push_back(one.still);
        moving.push_back(one.moving);
    }
    return {median(std::move(still)), median(std::move(moving))};
}

}  // namespace

void FlickerMeter::add(size_t camera, size_t frame, const media::Image& truth, const media::Image& render) {
    std::optional<Shown>& last = last_[camera];
    if (last && last->frame + 1 == frame) {
        Sums& sums = steps_[last->frame];
        for (size_t at = 0; at < truth.rgba.size(); at += 4) {
            const uint8_t *before = &last->truth.rgba[at], *after = &truth.rgba[at];
            const bool still = std::equal(before, before + 3, after);
            if (still && std::equal(before, before + 3, background_)) continue;  // not the performer
            for (size_t c = at; c < at + 3; ++c) {
                const int change = render.rgba[c] - last->render.rgba[c];
                const int wrong = std::abs(change - (truth.rgba[c] - last->truth.rgba[c]));
                (still ? sums.still : sums.moving) += wrong;
                (still ? sums.still_values : sums.moving_values)++;
            }
        }
    }
    last = Shown{frame, truth, render};
}

std::optional<FlickerLevels> FlickerMeter::step(size_t i) const {
    const Sums& sums = steps_[i];
    if (sums.still_values + sums.moving_values == 0) return std::nullopt;
    const auto mean = [](double sum, uint64_t values) {
        return sum / static_cast<double>(std::max<uint64_t>(values, 1));
    };
    return FlickerLevels{mean(sums.still, sums.still_values), mean(sums.moving, sums.moving_values)};
}

std::optional<FlickerMeter::Summary> FlickerMeter::summary(const std::vector<size_t>& cuts) const {
    std::vector<FlickerLevels> at_cuts, elsewhere;
    for (size_t i = 0; i < steps_.size(); ++i)
        if (const std::optional<FlickerLevels> levels = step(i))
            (std::binary_search(cuts.begin(), cuts.end(), i) ? at_cuts : elsewhere).push_back(*levels);
    if (elsewhere.empty()) return std::nullopt;
    return Summary{medians(at_cuts), medians(elsewhere), at_cuts.size()};
}

}  // namespace neuvv::training
