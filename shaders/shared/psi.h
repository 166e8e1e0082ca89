// The neural mapping module Ψ(x, y, z) = (w^σ, w^γ, w^HH) as the passes of training and conversion bind it.
//
// Samples come in blocks of 64: block tile·n + i contains the i-th of the n samples of each of a tile's 64 rays, one
// ray per lane. The activations of a block are rows of 64 floats (16 texels); the rows of a layer follow those of the
// layer before it.
//
// Parameters are one array of floats, in this order:
//   hidden layers: matrices (inputs + 1) × width, row k the weights of input k, the last row the bias
//   head:          (width + 1) × head columns, not learnt: the output layer folded with the rows A_t and B_t of one
//   time,
//                  columns σ, γ, then w^HH as in the output layer, then zeros
//   output layer:  (width + 1) × outputs, columns in the order of a leaf's weights (voctree.h)
//   A, B:          frames × bases each
// As σ and γ depend on w^σ and w^γ only through A_t·w^σ and B_t·w^γ, folding is exact. A sample then costs 2 + 3 N
// columns in place of 2 C + 3 N, and ∂A, ∂B need no pass over the samples.
#ifndef NEUVV_SHARED_PSI_H
#define NEUVV_SHARED_PSI_H
#include "shared/hh_counts.h"
#include "shared/trace.h"

NEUVV_SHARED

CONSTEXPR uint kPsiBlock = 64u;  // samples and threads of a workgroup
CONSTEXPR uint kPsiBlockTexels = 16u;

// Bindings. Each pass has only those that it needs.
CONSTEXPR uint kPsiPoints = 0u;      // per sample: position in halves of the box's longest side, segment's length in m
CONSTEXPR uint kPsiDirections = 1u;  // per ray: unit direction, unused
CONSTEXPR uint kPsiRanges = 2u;      // per ray: metres along it where it enters and leaves the box, unused × 2
CONSTEXPR uint kPsiParameters = 3u;
CONSTEXPR uint kPsiActivations = 4u;  // per block psi_activation_rows rows
CONSTEXPR uint kPsiAdjoints = 5u;  // per block psi_adjoint_rows rows: ∂L/∂ the inputs of the activation functions
CONSTEXPR uint kPsiValues = 6u;    // per sample: σ in 1/m, linear RGB
CONSTEXPR uint kPsiValueAdjoints = 7u;
CONSTEXPR uint kPsiPartials = 8u;       // per split of the samples: gradients of hidden layers and head
CONSTEXPR uint kPsiGradients = 9u;      // as the parameters
CONSTEXPR uint kPsiFirstMoments = 10u;  // moments, as the parameters
CONSTEXPR uint kPsiSecondMoments = 11u;
CONSTEXPR uint kPsiCameras = 12u;
CONSTEXPR uint kPsiTiles = 13u;
CONSTEXPR uint kPsiRadiance = 14u;
CONSTEXPR uint kPsiRayAdjoints = 15u;

// Which activations a forward pass writes.
CONSTEXPR uint kPsiKeepNothing = 0u;
CONSTEXPR uint kPsiKeepAll = 1u;     // all rows, for the adjoint; and values
CONSTEXPR uint kPsiKeepHidden = 2u;  // only the last hidden layer's rows, block after block; no values

// The number of features of the encoding (x and sin, cos of 2^k π x for k < frequencies), rounded up to whole texels.
#ifdef __cplusplus
constexpr
#endif
    uint
    psi_inputs(uint frequencies) {
    return (3u + 6u * frequencies + 3u) / 4u * 4u;
}

// Columns of the head.
#ifdef __cplusplus
constexpr
#endif
    uint
    psi_head_columns(uint degree) {
    return (2u + 3u * hh_count(degree) + 31u) / 32u * 32u;
}

// Rows of a block's activations: encoding, hidden layers, head.
#ifdef __cplusplus
constexpr
#endif
    uint
    psi_activation_rows(uint inputs, uint width, uint layers, uint head_columns) {
    return inputs + layers * width + head_columns;
}
#ifdef __cplusplus
constexpr
#endif
    uint
    psi_adjoint_rows(uint width, uint layers, uint head_columns) {
    return layers * width + head_columns;
}

// The offset of a hidden layer's matrix among the parameters, in floats; for the number of hidden layers, the head's.
#ifdef __cplusplus
constexpr
#endif
    uint
    psi_layer_offset(uint layer, uint inputs, uint width) {
    return layer == 0u ? 0u : (inputs + 1u + (layer - 1u) * (width + 1u)) * width;
}

// psi_sample.comp, psi_resample.comp
struct PsiRayPush {
    vec4 box_min;   // metres
    vec4 box_size;  // metres
    vec4 centre;    // metres; w: 2 / the box's longest side
    uint tiles;
    uint coarse;  // samples per ray of the first pass
    uint fine;    // samples per ray of the second pass
    uint seed;
};

// psi_forward.comp, psi_adjoint.comp, psi_composite.comp, psi_composite_adjoint.comp
struct PsiBlockPush {
    uint blocks;
    uint samples_per_ray;
    uint keep;      // kPsiKeep…
    float revival;  // 1/m, psi_head.glsl; negative: none
};

// psi_weights_adjoint.comp, dispatched once per layer
struct PsiWeightsPush {
    uint blocks;
    uint splits;           // workgroups that share the samples
    uint inputs;           // rows of the matrix without the bias
    uint outputs;          // columns of the matrix
    uint input_row;        // the first row of the layer's inputs among the block's activations
    uint output_row;       // the first row of its outputs among the block's adjoints
    uint matrix_offset;    // among the parameters, in floats
    uint partials_stride;  // floats of one split's partial sums
};

// psi_reduce.comp
struct PsiReducePush {
    uint count;  // parameters with partial sums
    uint splits;
};

// psi_fold.comp, psi_fold_adjoint.comp
struct PsiFoldPush {
    float frame;  // 0..frames−1
    uint frames;
    uint bases;
    uint outputs;
    uint head_offset;  // among the parameters, in floats, as the next two
    uint output_offset;
    uint sigma_rows_offset;  // of A; B follows
    float density;           // 1/m for one unit of the network's w^σ
};

// psi_adam.comp. With `emit`, parameters do not move; the gradients are only written out.
struct PsiAdamPush {
    float beta1;
    float beta2;
    float epsilon;
    float bias1;  // 1 − β1^step
    float bias2;
    uint emit;
    uint head_offset;  // the head, from here to output_offset, is not learnt and skipped
    uint output_offset;
    uint sigma_rows_offset;  // from here on the learning rate is rows_rate
    uint count;
    float rate;
    float rows_rate;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::PsiRayPush) == 64);
static_assert(sizeof(neuvv::PsiBlockPush) == 16);
static_assert(sizeof(neuvv::PsiWeightsPush) == 32);
static_assert(sizeof(neuvv::PsiFoldPush) == 32);
static_assert(sizeof(neuvv::PsiAdamPush) == 48);
#endif
#endif
