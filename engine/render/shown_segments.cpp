#include "render/shown_segments.h"

#include <algorithm>

#include "voctree/clip.h"

namespace neuvv::render {

std::vector<Instance> ShownSegments::show(const std::vector<voctree::SegmentShare>& shares, const Changed& changed) {
    const auto is_named = [&](uint32_t segment) {
        return std::ranges::any_of(shares, [&](const voctree::SegmentShare& one) { return one.at.segment == segment; });
    };
    std::vector<uint32_t> missing;
    for (const voctree::SegmentShare& one : shares)
        if (!fields_.contains(one.at.segment)) missing.push_back(one.at.segment);
    if (!missing.empty()) {
        // Those that are not shown any more exist until the renderer has others.
        std::map<uint32_t, std::unique_ptr<const Field>> dropped;
        for (auto at = fields_.begin(); at != fields_.end();) {
            const auto one = at++;
            if (!is_named(one->first)) dropped.insert(fields_.extract(one));
        }
        if (!fields_.empty() && !dropped.empty()) {
            changed(fields());
            dropped.clear();
        }
        for (const uint32_t segment : missing)
            fields_[segment] =
                std::make_unique<const Field>(upload_(voctree::read_shown_segment(clip_.segments[segment]), segment));
        changed(fields());
    }
    std::vector<Instance> instances;
    for (const voctree::SegmentShare& one : shares) {
        Instance& instance = instances.emplace_back();
        instance.frame = one.at.frame;
        instance.density = one.share;
        instance.field = static_cast<uint32_t>(std::distance(fields_.begin(), fields_.find(one.at.segment)));
    }
    return instances;
}

std::vector<const Field*> ShownSegments::fields() const {
    std::vector<const Field*> all;
    for (const auto& [segment, field] : fields_) all.push_back(field.get());
    return all;
}

}  // namespace neuvv::render
