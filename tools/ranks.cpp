#include "tools/ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <vector>

#include "base/error.h"
#include "gpu/device.h"

namespace neuvv::tools {

namespace {

// The variables in which a starter of processes says who is who.
struct Starter {
    const char *rank, *count, *local;
    const char *on_machine, *machines;  // how many ranks its machine has, or how many machines there are
    std::vector<const char*> job;       // together they name a start
};

const std::vector<Starter>& starters() {
    static const std::vector<Starter> all = {{"OMPI_COMM_WORLD_RANK",
                                              "OMPI_COMM_WORLD_SIZE",
                                              "OMPI_COMM_WORLD_LOCAL_RANK",
                                              "OMPI_COMM_WORLD_LOCAL_SIZE",
                                              "",
                                              {"PMIX_NAMESPACE"}},
                                             {"SLURM_PROCID",
                                              "SLURM_STEP_NUM_TASKS",
                                              "SLURM_LOCALID",
                                              "",
                                              "SLURM_STEP_NUM_NODES",
                                              {"SLURM_JOB_ID", "SLURM_STEP_ID", "SLURM_RESTART_COUNT"}}};
    return all;
}

std::string text_of(const char* variable) {
    const char* value = std::getenv(variable);
    return value ? value : "";
}

uint32_t number_of(const char* variable) {
    const std::string text = text_of(variable);
    uint32_t number = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (problem != std::errc() || end != text.data() + text.size())
        throw InputError(variable, text, "is no number", "start the program by mpirun or srun, or without it");
    return number;
}

}  // namespace

Ranks ranks_of_environment() {
    for (const Starter& starter : starters()) {
        if (text_of(starter.rank).empty() || text_of(starter.count).empty()) continue;
        Ranks ranks{.rank = number_of(starter.rank), .count = number_of(starter.count)};
        if (ranks.count == 0 || ranks.rank >= ranks.count)
            throw InputError(starter.rank, text_of(starter.rank), fmt::format("is no rank of {}", ranks.count),
                             "start the program by mpirun or srun, or without it");
        if (ranks.count == 1) return ranks;
        if (!text_of(starter.local).empty()) ranks.local = number_of(starter.local);
        if (!text_of(starter.on_machine).empty()) ranks.on_machine = std::max(number_of(starter.on_machine), 1u);
        if (!text_of(starter.machines).empty()) {
            const uint32_t machines = std::max(number_of(starter.machines), 1u);
            ranks.on_machine = (ranks.count + machines - 1) / machines;
        }
        for (const char* part : starter.job) ranks.job += text_of(part) + ".";
        return ranks;
    }
    return {};
}

std::string device_of_rank(const Ranks& ranks, const std::string& choice) {
    if (ranks.count == 1 || !choice.empty() || !text_of("NEUVV_DEVICE").empty()) return choice;
    const std::vector<uint32_t> devices = gpu::best_devices();
    return devices.empty() ? choice : std::to_string(devices[ranks.local % devices.size()]);
}

}  // namespace neuvv::tools
