// The header of a .nvs file, a clip as slices, compressed, that can be played from any of its groups of frames on:
// which groups and frames there are, and where their bytes stand. engine/stream/README.md specifies the bytes.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "stream/codec/frame_decoder.h"
#include "stream/transport/byte_source.h"

namespace neuvv::stream {

// A part of a box, in fractions of its edges. Where both corners are 0, nothing is in it.
struct BoxPart {
    std::array<float, 3> low{}, high{};
};

// A run of frames that is decoded without any others.
struct Group {
    uint32_t first = 0, frames = 0;
    Format format;
    std::array<float, 3> box_min{}, box_size{1, 1, 1};  // metres
    // What lies around the leaves of its frames. Nothing: an older file does not say it.
    std::optional<BoxPart> filled;
    uint64_t offset = 0;                        // of its tables in the file; the parts of its frames follow
    uint32_t table_bytes = 0, table_check = 0;  // as they are stored, deflated
};

struct FrameEntry {
    bool is_key = true;                     // it needs no other frame
    std::array<uint32_t, kParts> bytes{};   // of each part
    std::array<uint32_t, kParts> checks{};  // CRC-32 of each part
    uint64_t all_bytes() const;
};

// Where the clip is in the coordinates of its capture (voctree/files/world_frame.h): its point p is the capture's
// 10^step · origin + 10^unit · p.
struct CaptureFrame {
    std::array<int32_t, 3> origin{};
    int16_t step = 0, unit = 0;
    static constexpr int kMostExponent = 12;  // of both, also below 0
};

struct Index {
    float fps = 25;
    CaptureFrame capture;
    std::vector<Group> groups;       // in order, without gaps
    std::vector<FrameEntry> frames;  // of the whole clip
    uint32_t group_of(uint32_t frame) const;
    uint32_t key_of(uint32_t frame) const;  // the key frame from which on it is decoded
    // Where a part of a frame stands in the file.
    ByteRange place_of(uint32_t frame, Part part) const;
    // The tables of a group and all parts up to `last` of its frames, which stand together.
    ByteRange place_of_group(uint32_t group_index, Part last = kShFine) const;
};

constexpr uint32_t kMaxStreamFrames = 10'000'000;
constexpr uint32_t kMaxGroupFrames = 1000;

constexpr char kMagic[8] = {'N', 'V', 'S', 't', 'r', 'e', 'a', 'm'};
constexpr uint64_t kFixedBytes = 32;  // with which the header begins: its numbers of frames and groups

// Bytes of the header, as it is written now.
uint64_t header_bytes(uint64_t groups, uint64_t frames);
std::vector<uint8_t> bytes_of(const Index& index);

constexpr const char* kPublishAgain = "publish the clip again";  // what mends a damaged stream

// A header that cannot be: `place` is in it, empty where it is the file as a whole.
struct BadHeader : std::runtime_error {
    BadHeader(std::string where, const std::string& problem, std::string mend)
        : std::runtime_error(problem), place(std::move(where)), fix(std::move(mend)) {}
    std::string place, fix;
};
// How many bytes the header has that begins with these kFixedBytes. Throws BadHeader.
uint64_t read_header_size(std::span<const uint8_t> fixed);
// The whole header of a file of so many bytes. Throws BadHeader.
Index read_index(std::span<const uint8_t> header, uint64_t file_bytes);

// CRC-32 as zip has it.
uint32_t check_of(std::span<const uint8_t> bytes);

}  // namespace neuvv::stream
