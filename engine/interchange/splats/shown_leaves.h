// How much of images each leaf makes, seen from all around.
#pragma once

#include "slice/slice.h"

namespace neuvv::interchange {

// Replaces `shown` of all leaves, as a new slice has it, by the mean of images from 26 directions around the
// leaves, in m²; leaves that are hidden in all of them keep a tenth. Takes some seconds of a core for a frame of some
// 100,000 leaves.
void measure_shown(slice::Slice& volume);

}  // namespace neuvv::interchange
