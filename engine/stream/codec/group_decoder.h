// The decoder as C functions, for programs that are no C++, and for browsers (tests/stream/webassembly): the frames of
// one group, in their order, from bytes in memory. Nothing throws. One group is decoded by one thread at a time.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct NeuvvGroupDecoder NeuvvGroupDecoder;

// A leaf, as engine/stream/README.md has it.
typedef struct {
    uint64_t cell;
    uint32_t depth;
} NeuvvLeaf;

// `tables`: those of the group, inflated. `depth`, `degree` and `most_leaves` are what the stream's head says of the
// group. `budget`: about how many leaves a frame shall have at most, 0: no limit. Where a key frame has more, the
// finest leaves of it, and of the frames up to the next one, are twice or four times as large. Null where these numbers
// or the tables cannot be. To be freed by neuvv_group_free.
NeuvvGroupDecoder* neuvv_group_new(const uint8_t* tables, size_t table_bytes, uint32_t depth, uint32_t degree,
                                   uint32_t most_leaves, uint32_t budget);
void neuvv_group_free(NeuvvGroupDecoder* decoder);

// Decodes the next frame of the group from its first parts, 1 to 5, which stand one after the other in `bytes`; their
// lengths are in `part_bytes`; coarser frames need no more than 3. Returns how many leaves the frame has, or −1 where
// the bytes are no frame: then, only a key frame can follow. A frame that repeats some of the one before must have as
// many parts.
int32_t neuvv_group_decode(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                           const uint32_t* part_bytes, uint32_t parts);
// The same in two steps, for who measures them: first the shape, after which leaves are those of the stream, then the
// planes. Both get the bytes of all the parts.
int32_t neuvv_group_decode_shape(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                                 const uint32_t* part_bytes, uint32_t parts);
int32_t neuvv_group_decode_planes(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                                  const uint32_t* part_bytes, uint32_t parts);

// The second step from the beginnings of the coarse streams of a key frame, for a first picture from few bytes. `bytes`
// has two parts, the second one with lengths of the streams that say how much of each is there, a multiple of 2. No
// other frame can repeat leaves of this one. Returns what neuvv_group_decode returns.
int32_t neuvv_group_decode_beginnings(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                                      const uint32_t* part_bytes);

// Of the last frame: by how many levels its finest leaves are larger than the stream's.
uint32_t neuvv_group_coarser(const NeuvvGroupDecoder* decoder);
// Of the last frame, until the next call: its leaves, and of each plane a number for each leaf. Null where there are
// none.
const NeuvvLeaf* neuvv_group_leaves(const NeuvvGroupDecoder* decoder);
const int16_t* neuvv_group_plane(const NeuvvGroupDecoder* decoder, uint32_t plane);
// What is wrong with the bytes of the last call; empty where nothing is.
const char* neuvv_group_error(const NeuvvGroupDecoder* decoder);

#ifdef __cplusplus
}
#endif
