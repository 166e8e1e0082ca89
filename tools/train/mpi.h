// Open MPI, loaded when several processes train one tree together, so that the program also runs where it is missing.
#pragma once

#include "tools/ranks.h"
#include "training/step/team.h"

namespace neuvv::tools {

// The team of all ranks that mpirun or srun started. It must be called at most once in a process, by its main thread,
// which alone may call the team's functions afterwards. Where a rank dies, its starter must end the others, as mpirun
// does, and srun with --kill-on-bad-exit. Throws InputError where there is no Open MPI, and where its ranks are not
// those of the environment.
training::Team join_team(const Ranks& ranks);

}  // namespace neuvv::tools
