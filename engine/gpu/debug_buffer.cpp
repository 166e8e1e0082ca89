#include "gpu/debug_buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace neuvv::gpu {

namespace {

std::function<void(const std::string&)> message_sink;

}  // namespace

void set_shader_message_sink(std::function<void(const std::string&)> sink) {
    message_sink = std::move(sink);
}

DebugBuffer::DebugBuffer(const Device& device)
    : buffer_(device, "shader debug", sizeof(DebugHeader) + kMaxDebugRecords * sizeof(DebugRecord),
              MemoryKind::kReadback) {
    *buffer_.as<DebugHeader>() = {};
}

std::vector<DebugRecord> DebugBuffer::drain(uint64_t& lost) {
    const std::lock_guard lock(mutex_);
    auto* header = buffer_.as<DebugHeader>();
    const uint32_t count = std::min(header->count, kMaxDebugRecords);
    lost = header->count - count;
    std::vector<DebugRecord> records(count);
    if (count > 0) std::memcpy(records.data(), header + 1, count * sizeof(DebugRecord));
    header->count = 0;
    return records;
}

void DebugBuffer::report() {
    if (!message_sink) return;
    uint64_t lost = 0;
    for (const DebugRecord& record : drain(lost)) message_sink(text_of(record));
    if (lost > 0) message_sink(fmt::format("{} more records had no room", lost));
}

std::string text_of(const DebugRecord& record) {
    const bool assertion = (record.code & kDebugAssert) != 0;
    const auto& w = record.words;
    return fmt::format("{} {}{} at ({}, {}, {}): {} {} {} {} ({:g} {:g} {:g} {:g})", assertion ? "assertion" : "print",
                       record.code & ~kDebugAssert, assertion ? " failed" : "", record.x, record.y, record.z, w.x, w.y,
                       w.z, w.w, std::bit_cast<float>(w.x), std::bit_cast<float>(w.y), std::bit_cast<float>(w.z),
                       std::bit_cast<float>(w.w));
}

}  // namespace neuvv::gpu
