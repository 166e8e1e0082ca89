// The verbs of `neuvv skeleton` that stand in files of their own.
#pragma once

#include "tools/commands.h"

namespace neuvv::tools {

void add_skeleton_compare(Command group);
void add_skeleton_follow(Command group);

}  // namespace neuvv::tools
