// Ranks: the processes that mpirun (Open MPI) or srun (Slurm) started together. Each is told its number by its
// environment. Segments and parts of a render are shared through the folder that all see; mpi.h has what needs MPI.
#pragma once

#include <cstdint>
#include <string>

namespace neuvv::tools {

struct Ranks {
    uint32_t rank = 0, count = 1;  // a program that was started alone is the only rank
    uint32_t local = 0;            // the rank's number among those of its machine
    uint32_t on_machine = 1;       // the ranks of its machine, where the starter says it
    std::string job;               // the same for all ranks, another one for each start; empty where there is one rank
    bool is_first() const { return rank == 0; }
};

// Throws InputError where the environment holds numbers that no starter sets.
Ranks ranks_of_environment();

// The device that a rank takes. Where the user chose none, by `choice` or NEUVV_DEVICE, the ranks of a machine take its
// best devices in turn.
std::string device_of_rank(const Ranks& ranks, const std::string& choice);

}  // namespace neuvv::tools
