// Which cameras are held out for the test where the user says so, whatever the files say.
#pragma once

#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// By camera whether it is held out. `holdout` is a number of cameras ("3", "0" for none) or a share of them ("12.5%",
// "0.125"), which are spread evenly over their order, or names with commas between them ("cam03,cam07"; "07," names
// one whose name is a number; a folder's name stands for all cameras in it). Throws InputError for a name that no
// camera has, and for more cameras than there are.
std::vector<bool> held_out(const std::vector<std::string>& cameras, const std::string& holdout);

// Leaves in the rig, which has the cameras of all splits, the shots of this one. Throws InputError where it has none.
void select_split(Rig& rig, const std::string& holdout, Split split);

}  // namespace neuvv::training
