#include "stream/transport/nvs_writer.h"

#include <zlib.h>

#include <cassert>
#include <new>

namespace neuvv::stream {

namespace {

std::vector<uint8_t> deflated(const std::vector<uint8_t>& bytes) {
    uLongf count = compressBound(static_cast<uLong>(bytes.size()));
    std::vector<uint8_t> result(count);
    if (compress2(result.data(), &count, bytes.data(), static_cast<uLong>(bytes.size()), 9) != Z_OK)
        throw std::bad_alloc();
    result.resize(count);
    return result;
}

}  // namespace

GroupBytes bytes_of(const std::vector<FrameSymbols>& frames) {
    Counts counts = no_counts();
    for (const FrameSymbols& frame : frames) count(frame, counts);
    const Tables tables = tables_of(counts);
    GroupBytes bytes{deflated(bytes_of(tables)), {}};
    for (const FrameSymbols& frame : frames) bytes.frames.push_back(bytes_of(frame, tables));
    return bytes;
}

uint64_t GroupBytes::count() const {
    uint64_t sum = tables.size();
    for (const FrameBytes& frame : frames)
        for (const std::vector<uint8_t>& part : frame.parts) sum += part.size();
    return sum;
}

Writer::Writer(const std::filesystem::path& path, float fps, uint32_t frames, uint32_t groups,
               const CaptureFrame& capture)
    : file_(path) {
    index_.fps = fps;
    index_.capture = capture;
    index_.frames.reserve(frames);
    index_.groups.reserve(groups);
    write(std::vector<uint8_t>(header_bytes(groups, frames)));
}

void Writer::write(const std::vector<uint8_t>& bytes) {
    file_.write(bytes.data(), bytes.size());
    next_ += bytes.size();
}

uint64_t Writer::add(Group group, const std::vector<FrameSymbols>& frames) {
    const GroupBytes bytes = bytes_of(frames);
    group.first = static_cast<uint32_t>(index_.frames.size());
    group.frames = static_cast<uint32_t>(frames.size());
    group.offset = next_;
    group.table_bytes = static_cast<uint32_t>(bytes.tables.size());
    group.table_check = check_of(bytes.tables);
    write(bytes.tables);
    for (size_t i = 0; i < frames.size(); ++i) {
        const FrameBytes& frame = bytes.frames[i];
        FrameEntry& entry = index_.frames.emplace_back();
        entry.is_key = frames[i].is_key;
        for (uint32_t part = 0; part < kParts; ++part) {
            entry.bytes[part] = static_cast<uint32_t>(frame.parts[part].size());
            entry.checks[part] = check_of(frame.parts[part]);
        }
    }
    for (uint32_t part = 0; part < kParts; ++part)
        for (const FrameBytes& frame : bytes.frames) write(frame.parts[part]);
    index_.groups.push_back(group);
    return next_ - group.offset + header_bytes(1, frames.size());
}

uint64_t Writer::finish() {
    assert(header_bytes(index_.groups.size(), index_.frames.size()) == index_.groups[0].offset &&
           "as many groups and frames as the constructor was told");
    const std::vector<uint8_t> header = bytes_of(index_);
    file_.write_at(0, header.data(), header.size());
    file_.finish();
    return next_;
}

}  // namespace neuvv::stream
