#include "render/clips/shown_segments.h"

#include <algorithm>
#include <functional>

#include "gpu/device.h"

namespace neuvv::render {

// Gives the renderer the fields of these segments, which are on the device.
void ShownSegments::show_only(std::vector<uint32_t> segments, const Changed& changed) {
    std::vector<const Field*> fields;
    for (const uint32_t segment : segments) fields.push_back(held_.at(segment).field.get());
    shown_ = std::move(segments);
    changed(fields);
}

// Drops segments that are not wanted, those first that were shown longest ago, until the others of them take no more
// than `bytes`. Fields that the renderer has are taken from it before, unless it would have none: then one stays.
void ShownSegments::drop_beyond(uint64_t bytes, const std::vector<uint32_t>& wanted, const Changed& changed) {
    std::vector<std::pair<uint64_t, uint32_t>> others;  // when they were shown last, and which they are
    for (const auto& [segment, held] : held_)
        if (!std::ranges::binary_search(wanted, segment)) others.emplace_back(held.last_shown, segment);
    std::ranges::sort(others, std::greater{});
    uint64_t kept = 0;
    std::vector<uint32_t> dropped;
    for (const auto& [when, segment] : others) {
        kept += device_bytes(*held_.at(segment).field);
        if (kept > bytes) dropped.push_back(segment);
    }
    std::vector<uint32_t> left;
    for (const uint32_t segment : shown_)
        if (std::ranges::find(dropped, segment) == dropped.end()) left.push_back(segment);
    if (left.empty() && !shown_.empty()) {
        std::erase(dropped, shown_[0]);
        left = {shown_[0]};
    }
    if (left != shown_) show_only(left, changed);
    for (const uint32_t segment : dropped) held_.erase(segment);
}

// Where the device has no memory, those that are only kept are dropped.
std::unique_ptr<const Field> ShownSegments::upload(uint32_t segment, const std::vector<uint32_t>& wanted,
                                                   const Changed& changed) {
    try {
        return std::make_unique<const Field>(upload_(clip_.segments[segment], segment));
    } catch (const gpu::VulkanError& error) {
        if (!error.out_of_memory() || kept_bytes_ == 0) throw;
    }
    kept_bytes_ = 0;  // from now on
    drop_beyond(0, wanted, changed);
    return std::make_unique<const Field>(upload_(clip_.segments[segment], segment));
}

std::vector<Instance> ShownSegments::show(const std::vector<voctree::SegmentShare>& shares, const Changed& changed) {
    std::vector<uint32_t> wanted;
    for (const voctree::SegmentShare& one : shares) wanted.push_back(one.at.segment);
    std::ranges::sort(wanted);
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    ++calls_;
    if (wanted != shown_) {
        drop_beyond(kept_bytes_, wanted, changed);
        for (const uint32_t segment : wanted) {
            if (held_.contains(segment)) continue;
            auto field = upload(segment, wanted, changed);
            held_[segment].field = std::move(field);
        }
        if (shown_ != wanted) show_only(wanted, changed);
        drop_beyond(kept_bytes_, wanted, changed);
    }
    for (const uint32_t segment : wanted) held_.at(segment).last_shown = calls_;
    std::vector<Instance> instances;
    for (const voctree::SegmentShare& one : shares) {
        Instance& instance = instances.emplace_back();
        instance.frame = one.at.frame;
        instance.density = one.share;
        instance.field = static_cast<uint32_t>(std::ranges::find(shown_, one.at.segment) - shown_.begin());
    }
    return instances;
}

}  // namespace neuvv::render
