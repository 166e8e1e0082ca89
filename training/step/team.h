// Processes that train one tree together: each traces its share of a step's rays, and all move their weights by the sum
// of all gradients.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::training {

using Bytes = std::vector<uint8_t>;

// All members call its functions, in the same order of calls. They need not be set where size is 1.
struct Team {
    uint32_t rank = 0, size = 1;
    // Gives each member the bytes of all members, in the order of ranks.
    std::function<std::vector<Bytes>(std::span<const uint8_t>)> gather;
    // Takes what this member has for each one, itself included, in the order of ranks; gives it what each has for it.
    std::function<std::vector<Bytes>(const std::vector<Bytes>&)> exchange;

    bool is_alone() const { return size == 1; }
    bool is_first() const { return rank == 0; }
};

// Throws RuntimeFailure: a member did not send what this one expects.
[[noreturn]] void throw_out_of_step();

// The value of each member, in the order of ranks. Throws RuntimeFailure where one is of another size.
template <typename T>
std::vector<T> gather_values(const Team& team, const T& own) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (team.is_alone()) return {own};
    std::vector<T> values(team.size);
    const std::vector<Bytes> all = team.gather({reinterpret_cast<const uint8_t*>(&own), sizeof(T)});
    for (size_t i = 0; i < values.size(); ++i) {
        if (all.at(i).size() != sizeof(T)) throw_out_of_step();
        std::memcpy(&values[i], all[i].data(), sizeof(T));
    }
    return values;
}

// Makes `tree` that of the first member, whose frames, bases and degree it must have already.
void adopt_first_tree(const Team& team, voctree::VOctree& tree);

}  // namespace neuvv::training
