// The neural mapping module Ψ(x, y, z) = (w^σ, w^γ, w^HH): layouts, bindings and push constants of its passes.
//
// Samples are processed in blocks of 64: block tile·n + i holds the i-th of the n samples of each of the tile's 64
// rays, one ray per lane. The activations of a block are rows of 64 floats, 16 texels each; the rows of a layer follow
// those of the layer before it.
//
// Parameters are one array of floats, in this order:
//   hidden layers: matrices of (inputs + 1) × width; row k has the weights of input k, the last row is the bias
//   head:          (width + 1) × head columns, not learnt: the output layer folded with the rows A_t and B_t of one
//                  time; its columns are σ, γ, then w^HH as in the output layer, then zeros
//   output layer:  (width + 1) × outputs; columns in the order of a leaf's weights (voctree.h)
//   A, B:          frames × bases each
// The fold is exact, as σ and γ depend on w^σ and w^γ only through A_t·w^σ and B_t·w^γ. A sample then costs 2 + 3 N
// columns in place of 2 C + 3 N, where N is the number of HH functions, and ∂A, ∂B need no pass over the samples.
#ifndef NEUVV_SHARED_PSI_H
#define NEUVV_SHARED_PSI_H
#include "shared/hh_counts.h"
#include "shared/trace.h"

NEUVV_SHARED

CONSTEXPR uint kPsiBlock = 64u;  // samples and threads of a workgroup
CONSTEXPR uint kPsiBlockTexels = 16u;

// Bindings. Each pass has those that it needs.
CONSTEXPR uint kPsiPoints = 0u;  // per sample: position in the network's coordinates, length of the segment in metres
CONSTEXPR uint kPsiDirections = 1u;  // per ray: unit direction, unused
CONSTEXPR uint kPsiRanges = 2u;      // per ray: distances in metres at which it enters and leaves the box, unused × 2
CONSTEXPR uint kPsiParameters = 3u;
CONSTEXPR uint kPsiActivations = 4u;  // per block psi_activation_rows rows
CONSTEXPR uint kPsiAdjoints = 5u;     // per block psi_adjoint_rows rows: ∂L/∂z; z enters an activation function
CONSTEXPR uint kPsiValues = 6u;       // per sample: σ in 1/m, linear RGB
CONSTEXPR uint kPsiValueAdjoints = 7u;
CONSTEXPR uint kPsiPartials = 8u;       // per split of the samples: sums of the gradients of hidden layers and head
CONSTEXPR uint kPsiGradients = 9u;      // laid out as the parameters
CONSTEXPR uint kPsiFirstMoments = 10u;  // laid out as the parameters, as are the second moments
CONSTEXPR uint kPsiSecondMoments = 11u;
CONSTEXPR uint kPsiCameras = 12u;
CONSTEXPR uint kPsiTiles = 13u;
CONSTEXPR uint kPsiRadiance = 14u;
CONSTEXPR uint kPsiRayAdjoints = 15u;

// What a forward pass writes into the activations.
CONSTEXPR uint kPsiKeepNothing = 0u;
CONSTEXPR uint kPsiKeepAll = 1u;     // all rows, as the adjoint needs them; colours are evaluated, too
CONSTEXPR uint kPsiKeepHidden = 2u;  // the rows of the last hidden layer alone, block after block; no σ and colour

// The number of features of the encoding: x and sin, cos of 2^k π x for k < frequencies, rounded up to whole texels.
#ifdef __cplusplus
constexpr
#endif
    uint
    psi_inputs(uint frequencies) {
    return (3u + 6u * frequencies + 3u) / 4u * 4u;
}

// The number of columns of the head: 2 + 3 N, rounded up to a multiple of 32.
#ifdef __cplusplus
constexpr
#endif
    uint
    psi_head_columns(uint degree) {
    return (2u + 3u * hh_count(degree) + 31u) / 32u * 32u;
}

// The number of rows in a block's activations: encoding, hidden layers, head.
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

// Where the matrix of a hidden layer begins among the parameters, in floats. Layer number `layers` is the head.
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
    float revival;  // 1/m; psi_head.glsl explains it; negative: relu's own derivative
};

// psi_weights_adjoint.comp, dispatched once per layer
struct PsiWeightsPush {
    uint blocks;
    uint splits;           // how many workgroups share the samples of one part of the matrix
    uint inputs;           // rows of the matrix but the bias
    uint outputs;          // its columns
    uint input_row;        // first row of the layer's inputs in a block's activations
    uint output_row;       // first row of the layer's outputs in a block's adjoints
    uint matrix_offset;    // among the parameters, in floats
    uint partials_stride;  // floats in the partial sums of one split
};

// psi_reduce.comp
struct PsiReducePush {
    uint count;  // how many parameters have partial sums
    uint splits;
};

// psi_fold.comp, psi_fold_adjoint.comp
struct PsiFoldPush {
    float frame;  // 0..frames−1
    uint frames;
    uint bases;
    uint outputs;
    uint head_offset;  // offsets are in floats
    uint output_offset;
    uint sigma_rows_offset;  // of A; B follows
    float density;           // 1/m: the meaning of one unit of the network's w^σ
};

// psi_adam.comp. With `emit` nothing moves, as only the gradients are needed.
struct PsiAdamPush {
    float beta1;
    float beta2;
    float epsilon;
    float bias1;  // 1 − β1^step
    float bias2;
    uint emit;
    uint head_offset;  // parameters from here to output_offset are the head, which is not learnt
    uint output_offset;
    uint sigma_rows_offset;  // parameters from here on move by rows_rate
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
