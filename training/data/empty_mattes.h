// Mattes that show nothing of the performer where those of other cameras do.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

struct EmptyMattes {
    std::vector<uint32_t> shots;      // of the rig, in its order
    size_t times = 0, looked_at = 0;  // of the rig, and of these those whose mattes were read
};

// Reads nothing but the file of each matte, at all times, or, where they are many, at times that are evenly spread: at
// most `most_images` in all. An empty matte counts where most images of its time show something. Images without a matte
// do. `progress` gets how many are read, and of how many, on any thread, one call at a time; may be empty. Throws
// InputError where one cannot be read.
EmptyMattes find_empty_mattes(const Rig& rig, size_t most_images,
                              const std::function<void(uint64_t done, uint64_t total)>& progress);

}  // namespace neuvv::training
