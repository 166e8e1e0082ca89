// The passes of training that run backwards: loss → rays → slice → weights and rows of A and B.
#ifndef NEUVV_SHARED_TRAINING_H
#define NEUVV_SHARED_TRAINING_H
#include "shared/slice.h"
#include "shared/trace.h"

NEUVV_SHARED

// The weights of the losses relative to L_rgb; training/step/loss.h names them.
struct LossWeights {
    float grad;        // of L_grad (errata 16)
    float point;       // of the point loss (ray_adjoint.glsl)
    float smoothness;  // of the smoothness of opacity (smooth.comp)
};

// The colour of a camera: it sees the premultiplied linear foreground (C, α) as A C + α b, before the background is
// added.
struct CameraColour {
    vec4 rows[3];  // for R, G, B: a row of A, and b
};

// loss.comp
CONSTEXPR uint kLossRadiance = 0u;
CONSTEXPR uint kLossTarget = 1u;  // per ray: premultiplied linear RGB and alpha of the foreground; alpha −1: no pixel
CONSTEXPR uint kLossBackground = 2u;       // per ray: linear RGB
CONSTEXPR uint kLossAdjoint = 3u;          // per ray: ∂L/∂(R, G, B, alpha)
CONSTEXPR uint kLossSums = 4u;             // per tile: (Σ rgb, Σ grad, pixels, unused)
CONSTEXPR uint kLossColours = 5u;          // per tile: the CameraColour of its camera
CONSTEXPR uint kLossColourGradients = 6u;  // per tile: ∂L/∂(its CameraColour)

struct LossPush {
    LossWeights weights;
    uint samples;  // a pixel is the mean of samples × samples neighbouring rays; must divide kTile
    uint colours;  // 1: cameras have colours of their own; else the two bindings are not used
};

// trace_adjoint.comp and direct_adjoint.comp have the bindings of trace.comp and direct.comp up to kTraceRadiance, and:
CONSTEXPR uint kTraceAdjoint = 10u;
CONSTEXPR uint kTraceGradients = 11u;  // per slot gradient_stride floats; direct: laid out as the weights
CONSTEXPR uint kTraceTarget = 13u;     // per ray, as kLossTarget
CONSTEXPR uint kTraceMaxWeight = 12u;  // per slot: bits of the largest blending weight of this step; 0: no ray came

struct TraceAdjointPush {
    vec4 box_min;  // as in TracePush
    vec4 box_size;
    TopBox top;
    LossWeights weights;
    float pixel_share;  // the share that a ray has in its pixel
    uint leaf_count;    // read by direct_adjoint.comp alone
};

// The number of floats in one slot's gradient: ∂L/∂σ, the opacity sensitivity Σ |α ∂L/∂α| over its samples, then
// ∂L/∂k_lm (R, G, B) per SH function.
#ifdef __cplusplus
constexpr
#endif
    uint
    gradient_stride(uint degree) {
    return 2u + 3u * sh_count(degree);
}

// touched.comp lists the slots that rays touched, so that the passes after it run over those alone.
CONSTEXPR uint kTouchedMaxWeight = 0u;
CONSTEXPR uint kTouchedLive = 1u;
CONSTEXPR uint kNoSlot = 0xffffffffu;  // an element of the list that is to be passed over (scatter_gradients.comp)
CONSTEXPR uint kTouchedSlots = 2u;     // slots, in the order of the workgroups that found them
CONSTEXPR uint kTouchedCount = 3u;     // a LiveCount

// gather_gradients.comp and scatter_gradients.comp, where several processes train a tree together. A record is what one
// process, or all together, say of a leaf: its index, the bits of the largest blending weight, its gradient.
CONSTEXPR uint kRecordsTouched = 0u;    // as kTouchedSlots: read, and written
CONSTEXPR uint kRecordsCount = 1u;      // gather: a LiveCount, of kRecordsTouched
CONSTEXPR uint kRecordsLeaves = 2u;     // gather: per slot its leaf
CONSTEXPR uint kRecordsHead = 2u;       // scatter: as kSliceHead
CONSTEXPR uint kRecordsGradients = 3u;  // as kTraceGradients
CONSTEXPR uint kRecordsMaxWeight = 4u;  // as kTraceMaxWeight
CONSTEXPR uint kRecords = 5u;           // record_words each

#ifdef __cplusplus
constexpr
#endif
    uint
    record_words(uint degree) {
    return 2u + gradient_stride(degree);
}

struct ScatterPush {
    uint records;
};

// smooth.comp has the bindings of trace.comp except those of rays and radiance, and:
CONSTEXPR uint kSmoothLeaves = 4u;     // per slot: its leaf
CONSTEXPR uint kSmoothPositions = 5u;  // per leaf: as Field::leaf_positions
CONSTEXPR uint kSmoothTouched = 6u;    // slots to run over
CONSTEXPR uint kSmoothCount = 7u;      // how many
CONSTEXPR uint kSmoothGradients = 8u;  // as kTraceGradients

struct SmoothPush {
    TopBox top;
    float box_size;  // the tree's edge, metres
    LossWeights weights;
    float pixel_share;  // as in TraceAdjointPush
};

// slice_adjoint.comp
CONSTEXPR uint kAdjointWeights = 0u;
CONSTEXPR uint kAdjointFirstMoments = 1u;   // first moments, laid out as the weights
CONSTEXPR uint kAdjointSecondMoments = 2u;  // second moments
CONSTEXPR uint kAdjointRows = 3u;
CONSTEXPR uint kAdjointLeaves = 4u;       // per slot: its leaf
CONSTEXPR uint kAdjointTouched = 5u;      // slots to run over
CONSTEXPR uint kAdjointCount = 10u;       // how many
CONSTEXPR uint kAdjointGradients = 6u;    // read and cleared
CONSTEXPR uint kAdjointMaxWeight = 7u;    // read and cleared
CONSTEXPR uint kAdjointLeafUse = 8u;      // per leaf since the tree last changed: largest weight, opacity sensitivity
CONSTEXPR uint kAdjointPartials = 9u;     // per workgroup: 2·kMaxBases sums of ∂L/∂A_t and ∂L/∂B_t
CONSTEXPR uint kAdjointLeafFrames = 11u;  // per 32 frames and leaf, leaves fastest: a bit for each frame that used it
CONSTEXPR uint kAdjointPositions = 12u;   // per leaf: as Field::leaf_positions
CONSTEXPR uint kAdjointHead = 13u;        // the slice, kept as the moved weights have it: as kSliceHead
CONSTEXPR uint kAdjointSh = 14u;          // as kSliceSh

// rows_adjoint.comp
CONSTEXPR uint kRowsAdjointPartials = 0u;
CONSTEXPR uint kRowsAdjointCount = 1u;
CONSTEXPR uint kRowsAdjointSigma = 2u;         // A, frames × bases
CONSTEXPR uint kRowsAdjointGamma = 3u;         // B
CONSTEXPR uint kRowsAdjointFirstMoments = 4u;  // moments: those of A, then those of B
CONSTEXPR uint kRowsAdjointSecondMoments = 5u;

// The optimiser's settings (Adam). With `emit` nothing moves, and the first moment receives the gradient itself.
struct AdamPush {
    float beta1;
    float beta2;
    float epsilon;
    float bias1;  // 1 − β1^step
    float bias2;
    uint emit;
};

struct SliceAdjointPush {
    AdamPush adam;
    uint leaf_count;
    uint frame;             // the frame at or before the slice's time
    uint frame_after;       // the next frame where the slice's time lies between frames, else the same
    float min_used_weight;  // a frame uses a leaf if it gives it at least this blending weight
    float sigma_rate;       // learning rate of w^σ, in optical depths over the leaf's edge
    float gamma_rate;       // of w^γ
    float colour_rate;      // of w^HH with l = 0
    float detail_rate;      // of w^HH with l > 0
    float box_size;         // the tree's edge, metres
    float least_depth;      // optical depth over the leaf's edge below which a density does not fall
};

struct RowsAdjointPush {
    AdamPush adam;
    float frame;
    uint frames;
    uint bases;
    float sigma_rate;  // learning rate of A
    float gamma_rate;  // of B
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::LossWeights) % 4 == 0 && alignof(neuvv::LossWeights) == 4);
static_assert(sizeof(neuvv::LossPush) == sizeof(neuvv::LossWeights) + 8);
static_assert(sizeof(neuvv::ScatterPush) == 4);
static_assert(sizeof(neuvv::SmoothPush) == sizeof(neuvv::LossWeights) + 16);
static_assert(sizeof(neuvv::TraceAdjointPush) == sizeof(neuvv::LossWeights) + 48);
static_assert(sizeof(neuvv::TraceAdjointPush) <= 128, "what Vulkan guarantees for push constants");
static_assert(sizeof(neuvv::SliceAdjointPush) == 64);
static_assert(sizeof(neuvv::RowsAdjointPush) == 44);
#endif
#endif
