#include "render/frame/slice_residency.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace neuvv::render {

SliceResidency::SliceResidency(const gpu::Device& device, std::vector<const Field*> fields, uint64_t budget)
    : device_(device),
      levels_(std::move(fields)),
      shares_(levels_.given()),
      budget_(slice_budget(device.memory(), budget)) {
    for (const Field* field : levels_.all) paints_.push_back(std::make_unique<Paints>(device, *field));
}

void SliceResidency::take_over(SliceResidency& other, const PerformerTarget& eyes) {
    shares_ = other.shares_;
    budget_ = other.budget_;
    paints_ = std::move(other.paints_);
    performers_ = std::move(other.performers_);
    far_levels_fit_ = other.far_levels_fit_;
    for (const auto& performer : performers_)
        if (performer) performer->replace_target(kEyeTarget, *eyes.target, eyes.views);
}

bool SliceResidency::has_fields(std::span<const Field* const> fields, uint32_t shares) const {
    return shares_ == shares && std::ranges::equal(fields, this->fields());
}

// Where each field's share of the budget changes, slices are created again.
void SliceResidency::change_fields(std::vector<const Field*> fields, uint32_t shares) {
    const bool same_shares = std::exchange(shares_, shares) == shares;
    FieldLevels next(std::move(fields));
    std::vector<std::unique_ptr<Paints>> paints(next.all.size());
    std::vector<std::unique_ptr<Performer>> performers(next.all.size());
    performers_.resize(levels_.all.size());
    for (size_t i = 0; i < next.all.size(); ++i) {
        const auto before = std::find(levels_.all.begin(), levels_.all.end(), next.all[i]);
        if (before == levels_.all.end()) {
            paints[i] = std::make_unique<Paints>(device_, *next.all[i]);
            continue;
        }
        const auto at = static_cast<size_t>(before - levels_.all.begin());
        paints[i] = std::move(paints_[at]);
        if (same_shares) performers[i] = std::move(performers_[at]);
    }
    performers_ = std::move(performers);  // before the paints that they refer to
    paints_ = std::move(paints);
    levels_ = std::move(next);
    far_levels_fit_.reset();
}

std::unique_ptr<Performer> SliceResidency::make_performer(uint32_t index,
                                                          std::span<const PerformerTarget> targets) const {
    const Field &field = *levels_.all[index], &finest = levels_.finest(index);
    uint64_t share = slice_share(budget_, shares_);
    if (&field != &finest) share = slice_share_of_level(share, finest, field);
    auto performer = std::make_unique<Performer>(device_, field, *paints_[index], share);
    for (const PerformerTarget& one : targets) performer->add_target(*one.target, one.views);
    return performer;
}

bool SliceResidency::ensure_performers(std::span<const PerformerTarget> targets, bool far_levels) {
    performers_.resize(levels_.all.size());
    for (uint32_t i = 0; i < levels_.given(); ++i)
        if (!performers_[i]) performers_[i] = make_performer(i, targets);
    if (!far_levels || far_levels_fit_) return true;
    try {
        for (uint32_t i = levels_.given(); i < levels_.all.size(); ++i)
            if (!performers_[i]) performers_[i] = make_performer(i, targets);
        far_levels_fit_ = true;
    } catch (const RuntimeFailure& error) {
        const auto* vulkan = dynamic_cast<const gpu::VulkanError*>(&error);
        if (vulkan && (vulkan->device_lost() || budget_ > 1)) throw;
        far_levels_fit_ = false;
    }
    return *far_levels_fit_;
}

void SliceResidency::free_far_levels() {
    for (uint32_t i = levels_.given(); i < levels_.all.size(); ++i) performers_[i].reset();
}

void SliceResidency::choose_far_levels(std::span<const stage::Camera> cameras, FrameSettings& settings) const {
    if (!settings.far_levels || !far_levels_fit_.value_or(false)) return;
    for (std::vector<Instance>* instances : {&settings.instances, &settings.next_instances})
        for (Instance& instance : *instances) {
            if (instance.paint != 0 || instance.field >= levels_.given()) continue;
            const uint32_t level =
                far_level_for(*levels_.all[instance.field], cameras, instance.world_from_performer, settings.samples);
            instance.field = levels_.index(instance.field, level);
        }
}

bool SliceResidency::replaces(const SliceRequests& requests) const {
    for (size_t i = 0; i < performers_.size(); ++i)
        if (performers_[i] && performers_[i]->replaces_slices(requests.now[i])) return true;
    return false;
}

void SliceResidency::request(const SliceRequests& requests) {
    for (size_t i = 0; i < performers_.size(); ++i)
        if (performers_[i]) performers_[i]->prepare(requests.now[i], requests.next[i]);
}

std::pair<Performer*, uint32_t> SliceResidency::nearest_built(const Instance& instance, float most_frames) const {
    std::pair<Performer*, uint32_t> nearest{nullptr, 0};
    if (instance.field >= levels_.given()) return nearest;
    float away = most_frames;
    const auto levels = 1 + static_cast<uint32_t>(levels_.all[instance.field]->coarser.size());
    for (uint32_t level = 0; level < levels; ++level) {
        const uint32_t index = levels_.index(instance.field, level);
        if (index >= performers_.size() || !performers_[index] || !performers_[index]->slices()) continue;
        const auto built = performers_[index]->slices()->nearest_built({instance.frame, instance.paint});
        if (!built || std::abs(built->first.frame - instance.frame) > away) continue;
        if (nearest.first && std::abs(built->first.frame - instance.frame) == away) continue;  // a finer level has it
        nearest = {performers_[index].get(), built->second};
        away = std::abs(built->first.frame - instance.frame);
    }
    return nearest;
}

bool SliceResidency::overflowed(uint32_t slot) const {
    return std::ranges::any_of(performers_, [slot](const auto& one) { return one && one->overflowed(slot); });
}

void SliceResidency::enlarge() {
    for (const auto& performer : performers_) {
        bool any = false;
        for (uint32_t slot = 0; performer && slot < kImagesUnderWay; ++slot) any |= performer->overflowed(slot);
        if (any) performer->enlarge_slices();
    }
}

uint64_t SliceResidency::live_entries(uint32_t slot) const {
    uint64_t entries = 0;
    for (const auto& performer : performers_)
        if (performer) entries += performer->used_entries(slot);
    return entries;
}

void SliceResidency::forget() {
    for (const auto& performer : performers_)
        if (performer && performer->slices()) performer->slices()->forget();
}

bool SliceResidency::drop() {
    uint64_t taken = 0;
    const bool any = std::ranges::any_of(performers_, [](const auto& performer) { return performer != nullptr; });
    for (const auto& performer : performers_) {
        const SliceCache* slices = performer ? performer->slices() : nullptr;
        if (slices) taken += slices->bytes();
    }
    if (taken > 0 && budget_ > 1) budget_ = std::max<uint64_t>(std::min(taken, budget_) / 2, 1);
    performers_.clear();
    if (far_levels_fit_.value_or(false))
        far_levels_fit_.reset();  // where they did not fit, they stay out until fields change
    return any;
}

bool SliceResidency::drop_after(const gpu::VulkanError& error) {
    const uint64_t before = budget_;
    drop();
    if (!error.out_of_memory() || before <= 1) return false;
    if (budget_ == before) budget_ = before / 2;
    return true;
}

}  // namespace neuvv::render
