// Writes .nvs files.
#pragma once

#include <filesystem>

#include "base/new_file.h"
#include "stream/transport/nvs_index.h"

namespace neuvv::stream {

// Writes a stream: what is before the frames is written at the end, when it is known.
class Writer {
  public:
    // The file appears, atomically, with finish(). `frames` and `groups` must be those that are added. Throws
    // RuntimeFailure where the disk fails, as all functions do.
    Writer(const std::filesystem::path& path, float fps, uint32_t frames, uint32_t groups,
           const CaptureFrame& capture = {});
    // Adds the next group: its frames in order, encoded as one group. The group's `first`, `offset` and tables are set
    // here. Returns their bytes, those in the index included.
    uint64_t add(Group group, const std::vector<FrameSymbols>& frames);
    // Returns the number of bytes.
    uint64_t finish();

  private:
    void write(const std::vector<uint8_t>& bytes);
    NewFile file_;
    Index index_;
    uint64_t next_ = 0;  // offset
};

// The bytes of a group's frames: its tables, deflated, and its frames.
struct GroupBytes {
    std::vector<uint8_t> tables;
    std::vector<FrameBytes> frames;
    uint64_t count() const;
};
GroupBytes bytes_of(const std::vector<FrameSymbols>& frames);

}  // namespace neuvv::stream
