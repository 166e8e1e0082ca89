// The verbs of `neuvv skeleton` that stand in files of their own, and what verbs that compare motions share.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "motion/compare/compare.h"
#include "motion/skeleton/skeleton_file.h"
#include "tools/commands.h"

namespace neuvv::tools {

void add_skeleton_extract(Command group);
void add_skeleton_compare(Command group);
void add_skeleton_follow(Command group);

// Reads a skeleton, and says on stderr what the reader chose or found odd.
motion::SkeletonClip read_motion(const std::string& file, const motion::SkeletonReading& reading = {});

// The limbs that are compared, without those of a list "head,left arm". Throws InputError.
std::vector<bool> counted_limbs(const std::string& left_out);
nlohmann::ordered_json comparison_json(const motion::Comparison& comparison);
void print_comparison(const motion::Comparison& comparison);

}  // namespace neuvv::tools
