// The gradients that rays gave to slots, taken off the device leaf by leaf and put back: so that processes which train
// a tree together can add up theirs.
#pragma once

#include <span>
#include <vector>

#include "render/slice.h"
#include "training/trace_adjoint.h"

namespace neuvv::training {

struct GradientRecords {
    GradientRecords(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
                    const SliceGradients& gradients);

    uint32_t words;           // of a record: record_words
    gpu::Buffer own, summed;  // records, host-mapped; as many as the slice has slots at most
    const SliceGradients& gradients;
    gpu::ComputePass gather, scatter;
    gpu::BindingSet gather_set, scatter_set;
};

// Records after record_touched. Fills `own` with a record for each slot that rays touched, in any order.
void record_gather(gpu::Commands& commands, const GradientRecords& records);

// Records the opposite, for the first `count` records of `summed`, whose leaves must all differ: gradients and
// max_weight of their slots become those of the records, and these slots are the touched ones. Leaves that are not live
// in the slice are left out.
void record_scatter(gpu::Commands& commands, const GradientRecords& records, uint32_t count);

// Adds up records of several processes, leaf by leaf: gradients are added in the order of the processes, of the largest
// blending weights the largest counts.
class RecordSum {
  public:
    RecordSum(uint32_t leaves, uint32_t words) : place_of_leaf_(leaves, kNowhere), words_(words) {}

    // Writes at most `room` records into `sum`, and returns how many. Throws RuntimeFailure where there are more, where
    // a process sent no whole number of records, or a leaf that the tree does not have.
    uint32_t add_up(const std::vector<std::span<const uint32_t>>& of_processes, uint32_t* sum, uint32_t room);

  private:
    static constexpr uint32_t kNowhere = UINT32_MAX;
    std::vector<uint32_t> place_of_leaf_;  // in `sum`; kNowhere between calls
    uint32_t words_;
};

}  // namespace neuvv::training
