#include "web/frame_pace.h"

#include <algorithm>
#include <memory>
#include <new>

#include "render/clips/frame_pace.h"

struct NeuvvFramePace {
    neuvv::render::FramePace pace;
};

NeuvvFramePace* neuvv_frame_pace_new(uint32_t frames_at_once) {
    return new (std::nothrow) NeuvvFramePace{neuvv::render::FramePace(frames_at_once)};
}

void neuvv_frame_pace_free(NeuvvFramePace* pace) {
    const std::unique_ptr<NeuvvFramePace> owner(pace);
}

void neuvv_frame_pace_learn(NeuvvFramePace* pace, uint32_t shapes, double shapes_s, double plane_bytes, double planes_s,
                            double upload_s) {
    pace->pace.learn({shapes, shapes_s, planes_s, static_cast<uint64_t>(plane_bytes)}, upload_s);
}

void neuvv_frame_pace_learn_arrival(NeuvvFramePace* pace, double seconds) {
    pace->pace.learn_arrival(seconds);
}

uint32_t neuvv_frame_pace_parts(NeuvvFramePace* pace, uint32_t group, const double* bytes_until, uint32_t frames,
                                double seconds, double bytes_per_s, double now_s) {
    neuvv::stream::GroupCost cost{{}, frames, seconds, group};
    std::transform(bytes_until, bytes_until + cost.bytes_until.size(), cost.bytes_until.begin(),
                   [](double bytes) { return static_cast<uint64_t>(bytes); });
    const auto rate = bytes_per_s < 0 ? std::nullopt : std::optional(bytes_per_s);
    return pace->pace.part_in_time(cost, rate, now_s) + 1;
}

double neuvv_frame_pace_lead(const NeuvvFramePace* pace) {
    return pace->pace.lead_s();
}
