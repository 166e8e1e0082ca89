#include "training/step/gradient_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "base/error.h"
#include "spirv/gather_gradients.comp.h"
#include "spirv/scatter_gradients.comp.h"
#include "training/step/array_buffers.h"

namespace neuvv::training {

namespace {

// As many records as there are slots, or as one bound storage buffer of the device holds.
uint32_t capacity_of(const gpu::Device& device, const render::Field& field, const render::Slice& slice) {
    const uint64_t bytes = std::min<uint64_t>(device.limits().maxStorageBufferRange, device.max_allocation_bytes());
    return static_cast<uint32_t>(std::min<uint64_t>(slice.capacity, bytes / (4 * record_words(field.hh_degree))));
}

std::span<const uint32_t> records_of(const Bytes& bytes, uint32_t words) {
    if (bytes.size() % (sizeof(uint32_t) * words) != 0) throw_out_of_step();
    return {reinterpret_cast<const uint32_t*>(bytes.data()), bytes.size() / sizeof(uint32_t)};
}

void add(uint32_t* to, const uint32_t* record, uint32_t words) {
    to[1] = std::max(to[1], record[1]);  // weights are not negative, so their bits are in their order
    for (uint32_t i = 2; i < words; ++i)
        to[i] = std::bit_cast<uint32_t>(std::bit_cast<float>(to[i]) + std::bit_cast<float>(record[i]));
}

}  // namespace

GradientRecords::GradientRecords(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
                                 const SliceGradients& given_gradients)
    : words(record_words(field.hh_degree)),
      capacity(capacity_of(device, field, slice)),
      own(device, "own gradient records", uint64_t{4} * words * capacity, gpu::MemoryKind::kReadback),
      summed(device, "summed gradient records", uint64_t{4} * words * capacity, gpu::MemoryKind::kUpload),
      gradients(given_gradients),
      gather(device, "gather gradients",
             array_buffers(device).fitting(gather_gradients_comp, gather_gradients_comp_storage), {field.hh_degree}),
      scatter(device, "scatter gradients",
              array_buffers(device).fitting(scatter_gradients_comp, scatter_gradients_comp_storage), {field.hh_degree}),
      gather_set(gather, {{kRecordsTouched, &gradients.touched},
                          {kRecordsCount, &gradients.touched_count},
                          {kRecordsLeaves, &slice.slot_leaf},
                          {kRecordsGradients, &gradients.gradients},
                          {kRecordsMaxWeight, &gradients.max_weight},
                          {kRecords, &own}}),
      scatter_set(scatter, {{kRecordsTouched, &gradients.touched},
                            {kRecordsHead, &slice.head},
                            {kRecordsGradients, &gradients.gradients},
                            {kRecordsMaxWeight, &gradients.max_weight},
                            {kRecords, &summed}}) {}

void record_gather(gpu::Commands& commands, const GradientRecords& records) {
    const gpu::PassScope scope(commands, "gather gradients");
    gpu::dispatch_indirect(commands, records.gather, records.gather_set, records.gradients.touched_count, 0, nullptr,
                           0);
    gpu::compute_barrier(commands);
}

void record_scatter(gpu::Commands& commands, const GradientRecords& records, uint32_t count) {
    const gpu::PassScope scope(commands, "scatter gradients");
    gpu::update(commands, records.gradients.touched_count,
                LiveCount{gpu::groups_of(count, kSliceGroup), 1, 1, count, 0});
    gpu::compute_barrier(commands);
    gpu::dispatch(commands, records.scatter, records.scatter_set, count, ScatterPush{count});
    gpu::compute_barrier(commands);
}

std::vector<Bytes> divide_records(std::span<const uint32_t> records, uint32_t words, uint32_t members) {
    std::vector<size_t> sizes(members);
    for (size_t at = 0; at < records.size(); at += words) sizes[records[at] % members] += sizeof(uint32_t) * words;
    std::vector<Bytes> divided(members);
    for (uint32_t member = 0; member < members; ++member) divided[member].reserve(sizes[member]);
    for (size_t at = 0; at < records.size(); at += words) {
        const auto* record = reinterpret_cast<const uint8_t*>(&records[at]);
        Bytes& to = divided[records[at] % members];
        to.insert(to.end(), record, record + sizeof(uint32_t) * words);
    }
    return divided;
}

void expect_room(uint64_t capacity, uint64_t records) {
    if (records > capacity)
        throw RuntimeFailure(
            fmt::format("rays touch {} leaves in a step, and this device has room for the gradients of {}", records,
                        capacity),
            Remedy::kLowerResolution);
}

uint32_t take_sums(const std::vector<Bytes>& of_members, uint32_t leaves, uint32_t words, std::span<uint32_t> room) {
    uint64_t bytes = 0;
    for (const Bytes& sums : of_members) bytes += sums.size();
    expect_room(room.size() / words, bytes / (sizeof(uint32_t) * words));
    size_t taken = 0;
    for (size_t member = 0; member < of_members.size(); ++member) {
        const std::span<const uint32_t> sums = records_of(of_members[member], words);
        for (size_t at = 0; at < sums.size(); at += words)
            if (sums[at] >= leaves || sums[at] % of_members.size() != member) throw_out_of_step();
        std::copy(sums.begin(), sums.end(), room.begin() + static_cast<ptrdiff_t>(taken));
        taken += sums.size();
    }
    return static_cast<uint32_t>(taken / words);
}

std::span<const uint32_t> RecordSum::add_up(const std::vector<Bytes>& of_processes) {
    sum_.clear();
    for (const Bytes& bytes : of_processes) {
        const std::span<const uint32_t> records = records_of(bytes, words_);
        for (const uint32_t* record = records.data(); record < records.data() + records.size(); record += words_) {
            if (record[0] >= place_of_leaf_.size()) throw_out_of_step();
            uint32_t& place = place_of_leaf_[record[0]];
            if (place == kNowhere) {
                place = static_cast<uint32_t>(sum_.size());
                sum_.insert(sum_.end(), record, record + words_);
            } else {
                add(&sum_[place], record, words_);
            }
        }
    }
    for (size_t i = 0; i < sum_.size(); i += words_) place_of_leaf_[sum_[i]] = kNowhere;
    return sum_;
}

}  // namespace neuvv::training
