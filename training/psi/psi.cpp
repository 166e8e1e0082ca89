#include "training/psi/psi.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

#include "gpu/host_copies.h"
#include "spirv/psi_adam.comp.h"
#include "spirv/psi_adjoint.comp.h"
#include "spirv/psi_composite.comp.h"
#include "spirv/psi_composite_adjoint.comp.h"
#include "spirv/psi_fold.comp.h"
#include "spirv/psi_fold_adjoint.comp.h"
#include "spirv/psi_forward.comp.h"
#include "spirv/psi_reduce.comp.h"
#include "spirv/psi_resample.comp.h"
#include "spirv/psi_sample.comp.h"
#include "spirv/psi_weights_adjoint.comp.h"
#include "training/step/array_buffers.h"
#include "training/tree/bases.h"

namespace neuvv::training {

namespace {

constexpr uint32_t kMaxSplits = 64;
// A unit of the network's w^σ means this optical depth along the box's longest side. The fog with which training begins
// has kInitialFog units, so that about a fifth of the light passes along that side.
constexpr float kUnitOpticalDepth = 30;
constexpr float kInitialFog = 0.05f;

constexpr VkFormat kVec4 = VK_FORMAT_R32G32B32A32_SFLOAT;

uint64_t parameter_bytes(const PsiShape& shape) {
    return uint64_t{16} * ((shape.parameter_count() + 3) / 4);
}

std::vector<uint32_t> network_constants(const PsiShape& shape) {
    return {shape.frequencies, shape.inputs(), shape.width, shape.layers, shape.hh_degree, shape.head_columns()};
}

// Fills a matrix with random numbers, uniform in ±gain · √(6 / real_inputs): He's variance for a gain of 1.
void fill_layer(float* matrix, uint32_t inputs, uint32_t real_inputs, uint32_t outputs, double gain,
                std::mt19937_64& random) {
    const double bound = gain * std::sqrt(6.0 / real_inputs);
    for (uint32_t k = 0; k < inputs; ++k)
        for (uint32_t o = 0; o < outputs; ++o) {
            const double uniform = static_cast<double>(random() >> 11) * 0x1p-53;
            matrix[size_t{k} * outputs + o] = static_cast<float>(bound * (2 * uniform - 1));
        }
}

}  // namespace

PsiNetwork initial_psi(const PsiShape& shape, glm::vec3 box_min, glm::vec3 box_size, uint64_t seed) {
    PsiNetwork network{shape, box_min, box_size, 1, {}};
    network.density = 0.5f * kUnitOpticalDepth * network.scale();
    network.parameters.assign(shape.parameter_count(), 0);
    std::mt19937_64 random(seed);
    for (uint32_t layer = 0; layer < shape.layers; ++layer)
        fill_layer(&network.parameters[psi_layer_offset(layer, shape.inputs(), shape.width)],
                   layer == 0 ? shape.inputs() : shape.width, layer == 0 ? 3 + 6 * shape.frequencies : shape.width,
                   shape.width, 1, random);
    float* output = &network.parameters[shape.output_offset()];
    fill_layer(output, shape.width, shape.width, shape.outputs(), 0.02, random);
    float* bias = output + size_t{shape.width} * shape.outputs();
    const std::vector<float> gamma = voctree::initial_gamma_weights(shape.bases),
                             hats = voctree::hat_basis(shape.frames, shape.bases);
    std::fill(bias, bias + shape.bases, kInitialFog);
    std::copy(gamma.begin(), gamma.end(), bias + shape.bases);
    std::copy(hats.begin(), hats.end(), &network.parameters[shape.sigma_rows_offset()]);
    std::copy(hats.begin(), hats.end(), &network.parameters[shape.gamma_rows_offset()]);
    return network;
}

PsiStep::PsiStep(const gpu::Device& device, const PsiNetwork& network, const PsiSampling& sampling, uint32_t cameras,
                 uint32_t tiles)
    : device_(device),
      network_(network),
      sampling_(sampling),
      splits_(std::min(kMaxSplits, tiles * sampling.fine)),
      rays_(device, cameras, tiles),
      samples_(kPsiBlock * rays_.tile_capacity * std::max(sampling.coarse, sampling.fine)),
      batch_(device, tiles),
      points_(device, "psi points", uint64_t{16} * samples_, gpu::MemoryKind::kDevice, kVec4),
      directions_(device, "psi directions", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kDevice, kVec4),
      ranges_(device, "psi ranges", uint64_t{16} * kTilePixels * tiles, gpu::MemoryKind::kDevice, kVec4),
      values_(device, "psi values", uint64_t{16} * samples_, gpu::MemoryKind::kDevice, kVec4),
      value_adjoints_(device, "psi value adjoints", uint64_t{16} * samples_, gpu::MemoryKind::kDevice, kVec4),
      parameters_(device, "psi parameters", parameter_bytes(network.shape), gpu::MemoryKind::kDevice, kVec4),
      gradients_(device, "psi gradients", parameter_bytes(network.shape), gpu::MemoryKind::kDevice),
      first_(device, "psi first moments", parameter_bytes(network.shape), gpu::MemoryKind::kDevice),
      second_(device, "psi second moments", parameter_bytes(network.shape), gpu::MemoryKind::kDevice),
      activations_(device, "psi activations", uint64_t{4} * network.shape.activation_rows() * samples_,
                   gpu::MemoryKind::kDevice, kVec4),
      adjoints_(device, "psi adjoints", uint64_t{4} * network.shape.adjoint_rows() * samples_, gpu::MemoryKind::kDevice,
                kVec4),
      partials_(device, "psi partials", uint64_t{4} * splits_ * network.shape.output_offset(),
                gpu::MemoryKind::kDevice),
      sums_(device, "psi loss sums", uint64_t{16} * tiles, gpu::MemoryKind::kReadback),
      fold_(device, "psi fold", psi_fold_comp, {network.shape.width, network.shape.head_columns()}),
      sample_(device, "psi sample", array_buffers(device).fitting(psi_sample_comp, psi_sample_comp_storage)),
      forward_(device, "psi forward", array_buffers(device).fitting(psi_forward_comp, psi_forward_comp_storage),
               network_constants(network.shape)),
      resample_(device, "psi resample", array_buffers(device).fitting(psi_resample_comp, psi_resample_comp_storage)),
      composite_(device, "psi composite",
                 array_buffers(device).fitting(psi_composite_comp, psi_composite_comp_storage)),
      composite_adjoint_(device, "psi composite adjoint",
                         array_buffers(device).fitting(psi_composite_adjoint_comp, psi_composite_adjoint_comp_storage)),
      adjoint_(device, "psi adjoint", array_buffers(device).fitting(psi_adjoint_comp, psi_adjoint_comp_storage),
               network_constants(network.shape)),
      weights_(device, "psi weights adjoint",
               array_buffers(device).fitting(psi_weights_adjoint_comp, psi_weights_adjoint_comp_storage),
               {network.shape.activation_rows(), network.shape.adjoint_rows()}),
      reduce_(device, "psi reduce", psi_reduce_comp),
      fold_adjoint_(device, "psi fold adjoint", psi_fold_adjoint_comp,
                    {network.shape.width, network.shape.head_columns()}),
      adam_(device, "psi adam", psi_adam_comp),
      loss_(device, rays_, batch_),
      commands_(device, "psi step") {
    assert(network.parameters.size() == network.shape.parameter_count() && network.shape.width % 32 == 0);
    const auto bind = [&](const gpu::ComputePass& pass) {
        return gpu::BindingSet(pass, {{kPsiPoints, &points_},
                                      {kPsiDirections, &directions_},
                                      {kPsiRanges, &ranges_},
                                      {kPsiParameters, &parameters_},
                                      {kPsiActivations, &activations_},
                                      {kPsiAdjoints, &adjoints_},
                                      {kPsiValues, &values_},
                                      {kPsiValueAdjoints, &value_adjoints_},
                                      {kPsiPartials, &partials_},
                                      {kPsiGradients, &gradients_},
                                      {kPsiFirstMoments, &first_},
                                      {kPsiSecondMoments, &second_},
                                      {kPsiCameras, &rays_.cameras},
                                      {kPsiTiles, &rays_.tiles},
                                      {kPsiRadiance, &rays_.radiance},
                                      {kPsiRayAdjoints, &batch_.adjoint}});
    };
    fold_set_ = bind(fold_);
    sample_set_ = bind(sample_);
    forward_set_ = bind(forward_);
    resample_set_ = bind(resample_);
    composite_set_ = bind(composite_);
    composite_adjoint_set_ = bind(composite_adjoint_);
    adjoint_set_ = bind(adjoint_);
    weights_set_ = bind(weights_);
    reduce_set_ = bind(reduce_);
    fold_adjoint_set_ = bind(fold_adjoint_);
    adam_set_ = bind(adam_);
    gpu::upload(device, parameters_, network.parameters.data(), network.parameters.size() * sizeof(float));
    gpu::run_once(device, "clear psi moments", [&](gpu::Commands& commands) {
        for (const gpu::Buffer* buffer : {&gradients_, &first_, &second_}) gpu::fill(commands, *buffer, 0);
        gpu::compute_barrier(commands);
    });
    network_.parameters.clear();
}

PsiFoldPush PsiStep::fold_push(float frame) const {
    const PsiShape& shape = network_.shape;
    return {frame,
            shape.frames,
            shape.bases,
            shape.outputs(),
            shape.head_offset(),
            shape.output_offset(),
            shape.sigma_rows_offset(),
            network_.density};
}

namespace {

template <typename Push>
void record_pass(gpu::Commands& commands, const gpu::ComputePass& pass, const gpu::BindingSet& set, uint32_t threads,
                 const Push& push) {
    const gpu::PassScope scope(commands, pass.name());
    gpu::dispatch(commands, pass, set, threads, push);
    gpu::compute_barrier(commands);
}

template <typename Push>
void record_groups(gpu::Commands& commands, const gpu::ComputePass& pass, const gpu::BindingSet& set, uint32_t groups,
                   const Push& push) {
    const gpu::PassScope scope(commands, pass.name());
    gpu::dispatch_groups(commands, pass, set, groups, push);
    gpu::compute_barrier(commands);
}

PsiAdamPush adam_push(const PsiShape& shape, const PsiStepSettings& settings) {
    const AdamSettings& adam = settings.adam;
    const auto bias = [&](float beta) {
        return static_cast<float>(1 - std::pow(static_cast<double>(beta), adam.step));
    };
    return {adam.beta1,
            adam.beta2,
            adam.epsilon,
            bias(adam.beta1),
            bias(adam.beta2),
            adam.emit_only ? 1u : 0u,
            shape.head_offset(),
            shape.output_offset(),
            shape.sigma_rows_offset(),
            shape.parameter_count(),
            settings.rate,
            settings.rows_rate};
}

}  // namespace

// Takes activations and adjoints of `blocks` blocks to the gradients of hidden layers and head.
void PsiStep::record_psi_weights(uint32_t blocks) {
    const PsiShape& shape = network_.shape;
    {
        const gpu::PassScope scope(commands_, weights_.name());
        for (uint32_t layer = 0; layer <= shape.layers; ++layer) {
            PsiWeightsPush push{};
            push.blocks = blocks;
            push.splits = splits_;
            push.inputs = layer == 0 ? shape.inputs() : shape.width;
            push.outputs = layer == shape.layers ? shape.head_columns() : shape.width;
            push.input_row = layer == 0 ? 0 : shape.inputs() + (layer - 1) * shape.width;
            push.output_row = layer * shape.width;
            push.matrix_offset = psi_layer_offset(layer, shape.inputs(), shape.width);
            push.partials_stride = shape.output_offset();
            const uint32_t matrix_tiles = (push.inputs + 63) / 64 * (push.outputs / 32);
            gpu::dispatch_groups(commands_, weights_, weights_set_, splits_ * matrix_tiles, push);
        }
        gpu::compute_barrier(commands_);
    }
    record_pass(commands_, reduce_, reduce_set_, shape.output_offset(), PsiReducePush{shape.output_offset(), splits_});
}

void PsiStep::record_psi_step(const PsiStepSettings& settings) {
    const PsiShape& shape = network_.shape;
    const uint32_t coarse = settings.tiles * sampling_.coarse, fine = settings.tiles * sampling_.fine;
    const PsiBlockPush coarse_push{coarse, sampling_.coarse, kPsiKeepNothing, 0};
    const PsiBlockPush fine_push{fine, sampling_.fine, kPsiKeepAll, settings.revival * network_.density};
    const PsiRayPush ray_push{glm::vec4(network_.box_min, 0),
                              glm::vec4(network_.box_size, 0),
                              glm::vec4(network_.centre(), network_.scale()),
                              settings.tiles,
                              sampling_.coarse,
                              sampling_.fine,
                              settings.seed};
    const PsiFoldPush fold = fold_push(settings.frame);

    record_pass(commands_, fold_, fold_set_, (shape.width + 1) * shape.head_columns(), fold);
    record_groups(commands_, sample_, sample_set_, settings.tiles, ray_push);
    record_groups(commands_, forward_, forward_set_, coarse, coarse_push);
    record_groups(commands_, resample_, resample_set_, settings.tiles, ray_push);
    record_groups(commands_, forward_, forward_set_, fine, fine_push);
    record_groups(commands_, composite_, composite_set_, settings.tiles, fine_push);
    record_loss(commands_, loss_, settings.tiles, settings.weights);
    record_groups(commands_, composite_adjoint_, composite_adjoint_set_, settings.tiles, fine_push);
    record_groups(commands_, adjoint_, adjoint_set_, fine, fine_push);
    record_psi_weights(fine);
    record_pass(commands_, fold_adjoint_, fold_adjoint_set_, shape.parameter_count() - shape.output_offset(), fold);
    record_pass(commands_, adam_, adam_set_, shape.parameter_count(), adam_push(shape, settings));
    gpu::copy(commands_, batch_.sums, sums_, uint64_t{16} * settings.tiles);
    gpu::host_barrier(commands_);
}

void PsiStep::submit(const PsiStepSettings& settings) {
    assert(settings.tiles <= rays_.tile_capacity && "more tiles than the step was made for");
    tiles_ = settings.tiles;
    commands_.begin();
    record_psi_step(settings);
    commands_.submit();
}

StepResult PsiStep::wait() {
    commands_.wait();
    return summed_losses(sums_.as<glm::vec4>(), tiles_);
}

PsiNetwork PsiStep::network() const {
    PsiNetwork network = network_;
    network.parameters.resize(network.shape.parameter_count());
    gpu::download(device_, parameters_, network.parameters.data(), network.parameters.size() * sizeof(float));
    return network;
}

std::vector<float> PsiStep::gradients() const {
    std::vector<float> gradients(network_.shape.parameter_count());
    gpu::download(device_, gradients_, gradients.data(), gradients.size() * sizeof(float));
    return gradients;
}

std::vector<glm::vec4> PsiStep::points() const {
    std::vector<glm::vec4> points(size_t{kPsiBlock} * tiles_ * sampling_.fine);
    gpu::download(device_, points_, points.data(), points.size() * sizeof(glm::vec4));
    return points;
}

std::vector<glm::vec4> PsiStep::values() const {
    std::vector<glm::vec4> values(size_t{kPsiBlock} * tiles_ * sampling_.fine);
    gpu::download(device_, values_, values.data(), values.size() * sizeof(glm::vec4));
    return values;
}

std::vector<float> PsiStep::hidden_at(const std::vector<glm::vec3>& positions_world) {
    const uint32_t width = network_.shape.width;
    std::vector<float> result(positions_world.size() * width);
    std::vector<glm::vec4> points;
    std::vector<float> rows;
    for (size_t first = 0; first < positions_world.size(); first += samples_) {
        const size_t count = std::min<size_t>(samples_, positions_world.size() - first);
        const auto blocks = static_cast<uint32_t>((count + kPsiBlock - 1) / kPsiBlock);
        points.assign(size_t{blocks} * kPsiBlock, glm::vec4(0));
        for (size_t i = 0; i < count; ++i)
            points[i] = glm::vec4((positions_world[first + i] - network_.centre()) * network_.scale(), 0);
        gpu::upload(device_, points_, points.data(), points.size() * sizeof(glm::vec4));
        gpu::run_once(device_, "psi hidden layer", [&](gpu::Commands& commands) {
            gpu::dispatch_groups(commands, forward_, forward_set_, blocks, PsiBlockPush{blocks, 1, kPsiKeepHidden, 0});
            gpu::compute_barrier(commands);
        });
        rows.resize(size_t{blocks} * kPsiBlock * width);
        gpu::download(device_, activations_, rows.data(), rows.size() * sizeof(float));
        for (size_t i = 0; i < count; ++i)
            for (uint32_t row = 0; row < width; ++row)
                result[(first + i) * width + row] = rows[(i / kPsiBlock * width + row) * kPsiBlock + i % kPsiBlock];
    }
    return result;
}

}  // namespace neuvv::training
