// One layer of the network on a block of 64 samples, in place in shared memory, forwards and backwards:
//   z_o = b_o + Σ_k W_ko h_k,   ∂h_k = Σ_o W_ko ∂z_o
// The 64 threads form a square of 8 × 8: each computes eight samples of every eighth texel of columns. For each k it
// reads 8 activations and as many weights for 64 multiply-adds. Weights come through caches, as all threads read the
// same row of at most 512 bytes (as texel buffers on a CPU device, three times as fast as a copy in shared memory).
// Bound by arithmetic: 2·inputs·outputs FLOP per sample for 4·inputs·outputs / 64 bytes of cached weights. Cooperative
// matrices could replace the inner loops of the two functions. The file that includes this one defines kWidth,
// kHeadColumns, kInputs and the binding `parameters`.
#ifndef NEUVV_PSI_LAYER_GLSL
#define NEUVV_PSI_LAYER_GLSL

const uint kMaxColumns = kWidth > kHeadColumns ? kWidth : kHeadColumns;  // of any layer's matrix
const uint kSharedRows = kInputs > kMaxColumns ? kInputs : kMaxColumns;
const uint kTileColumns = kMaxColumns / 32u;  // texels of columns that a thread computes
const uint kTileRows = kWidth / 8u;

// The rows of the block that are worked on: activations, or backwards their adjoints. Row by row, at most 32 KiB, 16
// KiB up to a width of 64.
shared vec4 act[kSharedRows * kPsiBlockTexels];

// The number of this thread's sample in a row.
float act_of_sample(uint row) {
    const uint lane = gl_LocalInvocationID.x;
    return act[row * kPsiBlockTexels + lane / 4u][lane % 4u];
}

void set_act_of_sample(uint row, float value) {
    const uint lane = gl_LocalInvocationID.x;
    act[row * kPsiBlockTexels + lane / 4u][lane % 4u] = value;
}

// From h to z, or with `relu` to relu(z). `first`: where the matrix begins, in texels; `columns`: its width in texels,
// a multiple of 8.
void layer_forward(uint inputs, uint first, uint columns, bool relu) {
    const uint sample_texel = gl_LocalInvocationID.x / 8u * 2u, column = gl_LocalInvocationID.x % 8u;
    vec4 z[kTileColumns][8];
    for (uint j = 0u; j < kTileColumns; ++j) {
        const vec4 bias = 8u * j < columns ? FETCH(parameters, int(first + inputs * columns + column + 8u * j))
                                           : vec4(0.0);
        for (uint i = 0u; i < 8u; ++i) z[j][i] = bias;
    }
    for (uint k = 0u; k < inputs; ++k) {
        const vec4 h0 = act[k * kPsiBlockTexels + sample_texel], h1 = act[k * kPsiBlockTexels + sample_texel + 1u];
        for (uint j = 0u; j < kTileColumns; ++j) {
            if (8u * j >= columns) break;
            const vec4 w = FETCH(parameters, int(first + k * columns + column + 8u * j));
            for (uint i = 0u; i < 4u; ++i) {
                z[j][i] += h0[i] * w;
                z[j][i + 4u] += h1[i] * w;
            }
        }
    }
    barrier();
    for (uint j = 0u; j < kTileColumns; ++j) {
        if (8u * j >= columns) break;
        for (uint m = 0u; m < 4u; ++m) {
            const uint at = (4u * (column + 8u * j) + m) * kPsiBlockTexels + sample_texel;
            const vec4 a = vec4(z[j][0][m], z[j][1][m], z[j][2][m], z[j][3][m]);
            const vec4 b = vec4(z[j][4][m], z[j][5][m], z[j][6][m], z[j][7][m]);
            act[at] = relu ? max(a, vec4(0.0)) : a;
            act[at + 1u] = relu ? max(b, vec4(0.0)) : b;
        }
    }
    barrier();
}

// From ∂z to ∂h, for a layer whose inputs are the kWidth outputs of a hidden layer.
void layer_adjoint(uint first, uint columns) {
    const uint sample_texel = gl_LocalInvocationID.x / 8u * 2u, column = gl_LocalInvocationID.x % 8u;
    vec4 d[kTileRows][2];
    for (uint j = 0u; j < kTileRows; ++j) d[j][0] = d[j][1] = vec4(0.0);
    for (uint o = 0u; o < columns; ++o) {
        vec4 z[4][2];
        for (uint m = 0u; m < 4u; ++m) {
            const uint at = (4u * o + m) * kPsiBlockTexels + sample_texel;
            z[m][0] = act[at];
            z[m][1] = act[at + 1u];
        }
        for (uint j = 0u; j < kTileRows; ++j) {
            const vec4 w = FETCH(parameters, int(first + (column + 8u * j) * columns + o));
            for (uint m = 0u; m < 4u; ++m) {
                d[j][0] += w[m] * z[m][0];
                d[j][1] += w[m] * z[m][1];
            }
        }
    }
    barrier();
    for (uint j = 0u; j < kTileRows; ++j) {
        const uint at = (column + 8u * j) * kPsiBlockTexels + sample_texel;
        act[at] = d[j][0];
        act[at + 1u] = d[j][1];
    }
    barrier();
}

#endif
