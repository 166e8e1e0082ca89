// Programs that Open MPI's mpirun starts in several processes. The program works without Open MPI, so tests that need
// it are skipped where it is missing; tools/packages-test.txt has it, so CI runs them.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

namespace neuvv::test {

// Whether there is an mpirun. Afterwards, it also starts programs for root, who runs the tests in containers.
inline bool prepare_mpirun() {
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    return std::system("mpirun --version >/dev/null 2>&1") == 0;
}

// `words`, the program first, in so many processes, which may be more than there are cores.
inline std::vector<std::string> under_mpirun(const char* processes, std::vector<std::string> words,
                                             const std::vector<std::string>& options = {}) {
    std::vector<std::string> all = {"/usr/bin/env", "mpirun", "--oversubscribe", "-n", processes};
    all.insert(all.end(), options.begin(), options.end());
    all.insert(all.end(), words.begin(), words.end());
    return all;
}

}  // namespace neuvv::test
