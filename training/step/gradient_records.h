// The gradients that rays gave to slots, taken off the device leaf by leaf and put back: so that processes which train
// a tree together can add up theirs.
#pragma once

#include <span>
#include <vector>

#include "render/volume/slices/slice.h"
#include "training/step/team.h"
#include "training/step/trace_adjoint.h"

namespace neuvv::training {

struct GradientRecords {
    GradientRecords(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
                    const SliceGradients& gradients);

    uint32_t words;     // of a record: record_words
    uint32_t capacity;  // records
    // Records, host-mapped. `summed` is for writing alone: reading it from the host is slow.
    gpu::Buffer own, summed;
    const SliceGradients& gradients;
    gpu::ComputePass gather, scatter;
    gpu::BindingSet gather_set, scatter_set;
};

// Records after record_touched. Fills `own` with a record for each slot that rays touched, in any order; those beyond
// its capacity are missing.
void record_gather(gpu::Commands& commands, const GradientRecords& records);

// Records the opposite, for the first `count` records of `summed`, whose leaves must all differ: gradients and
// max_weight of their slots become those of the records, and these slots are the touched ones, in the order of the
// records. In place of a leaf that is not live in the slice, kNoSlot stands.
void record_scatter(gpu::Commands& commands, const GradientRecords& records, uint32_t count);

// Divides records by the member that adds them up: those of leaf l by member l % members.
std::vector<Bytes> divide_records(std::span<const uint32_t> records, uint32_t words, uint32_t members);

// Writes the sums of all members' shares behind each other into `room`, and returns how many records they are. Throws
// RuntimeFailure where a member sent anything else than sums of its share of a tree of so many leaves, and where there
// is no room.
uint32_t take_sums(const std::vector<Bytes>& of_members, uint32_t leaves, uint32_t words, std::span<uint32_t> room);

// Throws RuntimeFailure where there is no room for so many records.
void expect_room(uint64_t capacity, uint64_t records);

// Adds up records of several processes, leaf by leaf: gradients are added in the order of the processes, of the largest
// blending weights the largest counts.
class RecordSum {
  public:
    RecordSum(uint32_t leaves, uint32_t words) : place_of_leaf_(leaves, kNowhere), words_(words) {}

    // Returns a record for each leaf that any process has one of; valid until the next call. Throws RuntimeFailure
    // where a process sent no whole number of records, or a leaf that the tree does not have.
    std::span<const uint32_t> add_up(const std::vector<Bytes>& of_processes);

  private:
    static constexpr uint32_t kNowhere = UINT32_MAX;
    std::vector<uint32_t> place_of_leaf_;  // where in sum_; kNowhere between calls
    std::vector<uint32_t> sum_;
    uint32_t words_;
};

}  // namespace neuvv::training
