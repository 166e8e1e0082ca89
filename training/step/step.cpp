#include "training/step/step.h"

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "gpu/host_copies.h"

namespace neuvv::training {

// The comments say what each pass reads → writes, by the names of buffers in their structs: Field (field_), Slice
// (slice_), RayBatch (rays_), LossBatch (batch_), SliceGradients (gradients_), Moments (moments_) and LeafTally
// (tally_).
void TrainingStep::record_gradients(const StepSettings& settings) {
    // field_ weights, sigma_basis, gamma_basis, node_cells → slice_ rows, node_live, head, slot_leaf, live, sh
    if (sliced_frame_ != settings.frame) render::record_slice(commands_, slicer_, settings.frame);
    sliced_frame_ = settings.frame;
    // field_ top, nodes, children; slice_ node_live, head, sh; rays_ cameras, tiles → rays_ radiance, depth
    render::record_trace(commands_, tracer_, settings.tiles, settings.stop);
    // rays_ radiance; batch_ target, background, colours → batch_ adjoint, sums, colour_gradients
    record_loss(commands_, loss_, settings.tiles, settings.weights, settings.samples, settings.colours);
    // what trace reads; rays_ radiance; batch_ adjoint, target → adds to gradients_ gradients, max_weight
    record_trace_adjoint(commands_, trace_adjoint_, settings.tiles, settings.stop, settings.weights,
                         settings.pixel_share());
    // gradients_ max_weight; slice_ live → gradients_ touched, touched_count
    record_touched(commands_, touched_list_);
    // batch_ sums, colour_gradients, slice_ live, gradients_ touched_count → the host
    if (settings.tiles > 0) gpu::copy(commands_, batch_.sums, sums_readback_, uint64_t{16} * settings.tiles);
    if (settings.colours && settings.tiles > 0)
        gpu::copy(commands_, batch_.colour_gradients, colours_readback_, sizeof(CameraColour) * settings.tiles);
    gpu::copy(commands_, slice_.live, live_readback_, sizeof(LiveCount));
    gpu::copy(commands_, gradients_.touched_count, touched_readback_, sizeof(LiveCount));
}

void TrainingStep::record_update(const StepSettings& settings) {
    if (settings.learn_rows) sliced_frame_.reset();
    // tree and slice at gradients_ touched and their neighbours → adds to gradients_ gradients
    if (settings.weights.smoothness > 0) record_smooth(commands_, smoother_, settings.weights, settings.pixel_share());
    // gradients_ touched, gradients, max_weight; slice_ rows, slot_leaf; moments_ → field_ weights, moments_, tally_,
    // slice_ head and sh of the moved weights; clears gradients and max_weight. Where rows learn, also gradients_
    // partials, and then gradients_ partials → field_ sigma_basis, gamma_basis, moments_ rows_first, rows_second
    record_slice_adjoint(commands_, slice_adjoint_, settings.frame, settings.rates, settings.adam, settings.learn_rows);
}

render::Field training_field(const gpu::Device& device, const voctree::VOctree& tree) {
    render::Field field = render::upload_field(device, tree, render::WeightPrecision::kFloat);
    if (tree.bases < tree.frames) field.busy_planes = field.basis_planes();
    return field;
}

TrainingStep::TrainingStep(const gpu::Device& device, const voctree::VOctree& tree, uint32_t cameras, uint32_t tiles,
                           const Team& team)
    : device_(device),
      team_(team),
      field_(training_field(device, tree)),
      slice_(device, field_, std::min(field_.leaf_count, max_training_slots(device, field_.hh_degree))),
      rays_(device, cameras, tiles),
      batch_(device, tiles),
      gradients_(device, field_, slice_),
      moments_(device, field_),
      tally_(device, tree),
      sums_readback_(device, "loss sums readback", uint64_t{16} * tiles, gpu::MemoryKind::kReadback),
      colours_readback_(device, "colour gradients readback", sizeof(CameraColour) * tiles, gpu::MemoryKind::kReadback),
      live_readback_(device, "live count readback", sizeof(LiveCount), gpu::MemoryKind::kReadback),
      touched_readback_(device, "touched count readback", sizeof(LiveCount), gpu::MemoryKind::kReadback),
      radiance_readback_(device, "radiance readback", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kReadback),
      slicer_(device, field_, slice_),
      tracer_(device, field_, slice_, rays_),
      loss_(device, rays_, batch_),
      trace_adjoint_(device, field_, slice_, rays_, batch_, gradients_, best_atomic_add(device)),
      touched_list_(device, slice_, gradients_),
      smoother_(device, field_, slice_, gradients_),
      slice_adjoint_(device, field_, slice_, gradients_, moments_, tally_),
      record_sum_(team.is_alone() ? 0 : field_.leaf_count, record_words(field_.hh_degree)),
      commands_(device, "training step") {
    if (!team.is_alone()) records_.emplace(device, field_, slice_, gradients_);
}

void TrainingStep::submit(const StepSettings& settings) {
    assert((!settings.learn_rows || field_.busy_planes == field_.basis_planes()) && "rows that learn are all busy");
    assert(settings.tiles <= rays_.tile_capacity && "more tiles than the step was made for");
    settings_ = settings;
    commands_.begin();
    record_gradients(settings);
    if (records_)
        record_gather(commands_, *records_);
    else
        record_update(settings);
    gpu::host_barrier(commands_);
    commands_.submit();
}

StepResult summed_losses(const glm::vec4* sums, uint32_t tiles) {
    StepResult result;
    double pixels = 0;
    for (uint32_t i = 0; i < tiles; ++i) {
        result.rgb_loss += static_cast<double>(sums[i].x);
        result.grad_loss += static_cast<double>(sums[i].y);
        pixels += static_cast<double>(sums[i].z);
    }
    result.rgb_loss /= std::max(pixels, 1.0);
    result.grad_loss /= std::max(pixels, 1.0);
    result.pixels = static_cast<uint64_t>(pixels);
    return result;
}

StepResult TrainingStep::own_result() const {
    StepResult result = summed_losses(sums_readback_.as<glm::vec4>(), settings_.tiles);
    const LiveCount& live = *live_readback_.as<LiveCount>();
    result.slots = std::min(live.slots, slice_.capacity);
    result.overflow = live.overflow;
    result.touched = touched_readback_.as<LiveCount>()->slots;
    return result;
}

StepResult TrainingStep::wait() {
    commands_.wait();
    pass_times_ = commands_.pass_times();
    const StepResult own = own_result();
    return records_ ? update_together(own) : own;
}

namespace {

// Losses are means over the pixels of all members.
StepResult summed_results(const std::vector<StepResult>& results) {
    StepResult sum;
    for (const StepResult& result : results) {
        const auto pixels = static_cast<double>(result.pixels);
        sum.rgb_loss += result.rgb_loss * pixels;
        sum.grad_loss += result.grad_loss * pixels;
        sum.pixels += result.pixels;
        sum.slots = std::max(sum.slots, result.slots);
        sum.overflow = std::max(sum.overflow, result.overflow);
    }
    sum.rgb_loss /= std::max(static_cast<double>(sum.pixels), 1.0);
    sum.grad_loss /= std::max(static_cast<double>(sum.pixels), 1.0);
    return sum;
}

}  // namespace

StepResult TrainingStep::update_together(const StepResult& own) {
    StepResult sum = summed_results(gather_values(team_, own));
    expect_room(records_->capacity, own.touched);
    const std::span<const uint32_t> touched(records_->own.as<uint32_t>(), size_t{records_->words} * own.touched);
    const std::span<const uint32_t> summed =
        record_sum_.add_up(team_.exchange(divide_records(touched, records_->words, team_.size)));
    const std::vector<Bytes> all = team_.gather({reinterpret_cast<const uint8_t*>(summed.data()), summed.size_bytes()});
    sum.touched = take_sums(all, field_.leaf_count, records_->words,
                            {records_->summed.as<uint32_t>(), size_t{records_->words} * records_->capacity});
    commands_.begin();
    record_scatter(commands_, *records_, sum.touched);
    record_update(settings_);
    commands_.submit();
    commands_.wait();
    const std::vector<gpu::PassTime> second_half = commands_.pass_times();
    pass_times_.insert(pass_times_.end(), second_half.begin(), second_half.end());
    return sum;
}

const glm::vec4* TrainingStep::trace(float frame, uint32_t tiles, float stop) {
    assert(tiles <= rays_.tile_capacity && "more tiles than the step was made for");
    commands_.begin();
    if (sliced_frame_ != frame) render::record_slice(commands_, slicer_, frame);
    sliced_frame_ = frame;
    render::record_trace(commands_, tracer_, tiles, stop);
    gpu::copy(commands_, rays_.radiance, radiance_readback_, uint64_t{16} * kTilePixels * tiles);
    gpu::host_barrier(commands_);
    commands_.submit();
    commands_.wait();
    return radiance_readback_.as<glm::vec4>();
}

void TrainingStep::download(voctree::VOctree& tree) const {
    assert(tree.leaf_count == field_.leaf_count && "the tree's topology changed");
    std::vector<float> planes(size_t{4} * field_.planes() * field_.leaf_count);
    neuvv::gpu::download(device_, field_.whole_weights(), planes.data(), planes.size() * sizeof(float));
    render::weights_from_planes(planes, tree);
    neuvv::gpu::download(device_, field_.sigma_basis, tree.sigma_basis.data(), tree.sigma_basis.size() * sizeof(float));
    neuvv::gpu::download(device_, field_.gamma_basis, tree.gamma_basis.data(), tree.gamma_basis.size() * sizeof(float));
}

}  // namespace neuvv::training
