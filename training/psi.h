// Ψ, the neural mapping module: an MLP from a place to the weights w^σ, w^γ, w^HH of a leaf, and a step of its
// training.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shared/psi.h"
#include "training/step.h"

namespace neuvv::training {

struct PsiShape {
    uint32_t frequencies = 8;  // of the positional encoding
    uint32_t width = 64;       // of a hidden layer: 32, 64 or 128
    uint32_t layers = 3;       // hidden ones
    uint32_t bases = 31;       // C
    uint32_t hh_degree = 1;
    uint32_t frames = 1;

    // Numbers of rows and columns, and where things begin among the parameters, in floats (shared/psi.h).
    uint32_t inputs() const { return psi_inputs(frequencies); }
    uint32_t head_columns() const { return psi_head_columns(hh_degree); }
    uint32_t outputs() const { return 2 * bases + 3 * hh_count(hh_degree); }
    uint32_t head_offset() const { return psi_layer_offset(layers, inputs(), width); }
    uint32_t output_offset() const { return head_offset() + (width + 1) * head_columns(); }
    uint32_t sigma_rows_offset() const { return output_offset() + (width + 1) * outputs(); }
    uint32_t gamma_rows_offset() const { return sigma_rows_offset() + frames * bases; }
    uint32_t parameter_count() const { return gamma_rows_offset() + frames * bases; }
    uint32_t activation_rows() const { return psi_activation_rows(inputs(), width, layers, head_columns()); }
    uint32_t adjoint_rows() const { return psi_adjoint_rows(width, layers, head_columns()); }
};

struct PsiNetwork {
    PsiShape shape;
    glm::vec3 box_min{0},
        box_size{1};                // metres; space is scaled by the longest side, so that frequencies are isotropic
    float density = 1;              // 1/m that one unit of its output w^σ means
    std::vector<float> parameters;  // shape.parameter_count()

    // xyz of a place in [−1, 1]³ of the longest side: (x − centre) · scale.
    glm::vec3 centre() const { return box_min + 0.5f * box_size; }
    float scale() const { return 2 / std::max({box_size.x, box_size.y, box_size.z}); }
};

// Random hidden layers (He), hat bases, thin grey fog everywhere. The same seed gives the same network.
PsiNetwork initial_psi(const PsiShape& shape, glm::vec3 box_min, glm::vec3 box_size, uint64_t seed);

// Samples a ray: `coarse` stratified ones that only find out where the matter is, then `fine` by their weights.
struct PsiSampling {
    uint32_t coarse = 24, fine = 24;
};

struct PsiStepSettings {
    float frame = 0;
    uint32_t tiles = 0;
    uint32_t seed = 0;                          // of the samples' places; another one every step
    LossWeights weights = kDefaultLossWeights;  // of which a network has L_grad alone
    float rate = 0, rows_rate = 0;              // of the network, of A and B
    float revival = 1;  // in units of the output w^σ; negative: relu's own derivative (psi_head.glsl)
    AdamSettings adam;  // emit_only: nothing moves, gradients() are this step's
};

// The device's memory of a network in training. Use as TrainingStep: fill rays() and batch(), submit(), wait().
class PsiStep {
  public:
    // Throws RuntimeFailure where the device cannot hold it: 4 · (rows + adjoint_rows) bytes a fine sample.
    PsiStep(const gpu::Device& device, const PsiNetwork& network, const PsiSampling& sampling, uint32_t cameras,
            uint32_t tiles);

    const render::RayBatch& rays() const { return rays_; }
    const LossBatch& batch() const { return batch_; }
    const PsiShape& shape() const { return network_.shape; }

    void submit(const PsiStepSettings& settings);
    StepResult wait();
    std::vector<gpu::PassTime> pass_times() const { return commands_.pass_times(); }

    // As they are now.
    PsiNetwork network() const;
    // Of the last step, as the parameters; those of the head are of the folded layer.
    std::vector<float> gradients() const;
    // The fine samples of the last step: places and lengths; σ and colour. Block after block (shared/psi.h).
    std::vector<glm::vec4> points() const;
    std::vector<glm::vec4> values() const;

    // The last hidden layer at places in the world, `width` floats each, in as many runs as its memory needs.
    std::vector<float> hidden_at(const std::vector<glm::vec3>& positions_world);

  private:
    // The whole step, pass by pass.
    void record_psi_step(const PsiStepSettings& settings);
    void record_psi_weights(uint32_t blocks);
    uint32_t samples() const { return kPsiBlock * rays_.tile_capacity * std::max(sampling_.coarse, sampling_.fine); }
    PsiFoldPush fold_push(float frame) const;

    const gpu::Device& device_;
    PsiNetwork network_;  // as it was at first
    PsiSampling sampling_;
    uint32_t splits_;
    render::RayBatch rays_;
    LossBatch batch_;
    gpu::Buffer points_, directions_, ranges_, values_, value_adjoints_;
    gpu::Buffer parameters_, gradients_, first_, second_, activations_, adjoints_, partials_;
    gpu::Buffer sums_;  // host's copy
    gpu::ComputePass fold_, sample_, forward_, resample_, composite_, composite_adjoint_, adjoint_, weights_, reduce_,
        fold_adjoint_, adam_;
    gpu::BindingSet fold_set_, sample_set_, forward_set_, resample_set_, composite_set_, composite_adjoint_set_,
        adjoint_set_, weights_set_, reduce_set_, fold_adjoint_set_, adam_set_;
    Loss loss_;
    gpu::Commands commands_;
    uint32_t tiles_ = 0;
};

}  // namespace neuvv::training
