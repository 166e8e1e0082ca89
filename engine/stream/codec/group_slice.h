// The decoder of group_decoder.h, as C++ sees it.
#pragma once

#include "stream/codec/group_decoder.h"
#include "stream/codec/quantised_slice.h"

namespace neuvv::stream {

// The frame that was decoded last, until the next call of neuvv_group_decode; null where there is none.
const QuantisedSlice* last_slice(const NeuvvGroupDecoder* decoder);

}  // namespace neuvv::stream
