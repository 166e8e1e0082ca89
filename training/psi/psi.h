// Ψ, the paper's neural mapping module: an MLP from a position in space to the weights w^σ, w^γ, w^HH of a leaf there,
// and a step of its training.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shared/psi.h"
#include "training/step/step.h"

namespace neuvv::training {

struct PsiShape {
    uint32_t frequencies = 8;  // of the positional encoding
    uint32_t width = 64;       // numbers in a hidden layer: 32, 64 or 128
    uint32_t layers = 3;       // hidden layers
    uint32_t bases = 31;       // C
    uint32_t hh_degree = 1;
    uint32_t frames = 1;

    // Counts of rows and columns, and offsets into the parameters, in floats. shared/psi.h explains the layout.
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
    glm::vec3 box_min{0}, box_size{1};  // world, metres
    float density = 1;                  // 1/m: the meaning of one unit of the network's output w^σ
    std::vector<float> parameters;      // shape.parameter_count()

    // The network's input for the position x is (x − centre()) · scale(). Its longest axis spans [−1, 1]; one scale for
    // all axes keeps the encoding's frequencies isotropic.
    glm::vec3 centre() const { return box_min + 0.5f * box_size; }
    float scale() const { return 2 / std::max({box_size.x, box_size.y, box_size.z}); }
};

// A network before training: random hidden layers (He's variance), hat bases, and outputs that mean thin grey fog
// everywhere. The same seed gives the same network.
PsiNetwork initial_psi(const PsiShape& shape, glm::vec3 box_min, glm::vec3 box_size, uint64_t seed);

// Samples per ray: `coarse` stratified samples only find where the matter is; the blending weights that they get then
// place the `fine` samples, from which the image is composited.
struct PsiSampling {
    uint32_t coarse = 24, fine = 24;
};

struct PsiStepSettings {
    float frame = 0;
    uint32_t tiles = 0;
    uint32_t seed = 0;                          // of the samples' positions; should differ from step to step
    LossWeights weights = kDefaultLossWeights;  // only that of L_grad is used
    float rate = 0, rows_rate = 0;              // learning rates of the network, and of A and B
    // Where σ = 0, gradients move A_t · w^σ up from anywhere, but down no further than −revival (in units of the output
    // w^σ). Negative: they move it only where σ > 0, as relu's own derivative says (psi_head.glsl).
    float revival = 1;
    AdamSettings adam;  // with emit_only nothing moves, and gradients() returns this step's
};

// A network in training and its buffers on the device. It is used like TrainingStep: fill rays() and batch(), submit(),
// wait().
class PsiStep {
  public:
    // Throws RuntimeFailure where the device's memory is too small. Most of it is taken by activations and their
    // adjoints: 4 · (activation_rows + adjoint_rows) bytes per sample, for the larger of coarse and fine samples.
    PsiStep(const gpu::Device& device, const PsiNetwork& network, const PsiSampling& sampling, uint32_t cameras,
            uint32_t tiles);

    const render::RayBatch& rays() const { return rays_; }
    const LossBatch& batch() const { return batch_; }
    const PsiShape& shape() const { return network_.shape; }

    void submit(const PsiStepSettings& settings);
    StepResult wait();
    std::vector<gpu::PassTime> pass_times() const { return commands_.pass_times(); }

    // The network with its current parameters.
    PsiNetwork network() const;
    // The gradients of the last step, laid out as the parameters; those of the head belong to the folded output layer.
    std::vector<float> gradients() const;
    // The fine samples of the last step, block after block (shared/psi.h): position (in the network's coordinates) and
    // length in metres; σ and colour.
    std::vector<glm::vec4> points() const;
    std::vector<glm::vec4> values() const;

    // The last hidden layer at these positions (world, metres), `width` floats each. It runs the network as often as
    // its buffers require.
    std::vector<float> hidden_at(const std::vector<glm::vec3>& positions_world);

  private:
    // The whole step, pass by pass.
    void record_psi_step(const PsiStepSettings& settings);
    void record_psi_weights(uint32_t blocks);
    PsiFoldPush fold_push(float frame) const;

    const gpu::Device& device_;
    PsiNetwork network_;  // without parameters, which are on the device
    PsiSampling sampling_;
    uint32_t splits_;
    render::RayBatch rays_;
    uint32_t samples_;  // that the buffers have room for
    LossBatch batch_;
    gpu::Buffer points_, directions_, ranges_, values_, value_adjoints_;
    gpu::Buffer parameters_, gradients_, first_, second_, activations_, adjoints_, partials_;
    gpu::Buffer sums_;  // the host's copy of LossBatch::sums
    gpu::ComputePass fold_, sample_, forward_, resample_, composite_, composite_adjoint_, adjoint_, weights_, reduce_,
        fold_adjoint_, adam_;
    gpu::BindingSet fold_set_, sample_set_, forward_set_, resample_set_, composite_set_, composite_adjoint_set_,
        adjoint_set_, weights_set_, reduce_set_, fold_adjoint_set_, adam_set_;
    Loss loss_;
    gpu::Commands commands_;
    uint32_t tiles_ = 0;
};

}  // namespace neuvv::training
