// Other walks: trace_tree.comp with a walk that does without something of march.glsl, for `neuvv-bench walk`. Bindings,
// threads and what is read and written are those of trace_tree.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#define OTHER_WALK
layout(constant_id = 7) const bool kRestart = false;   // reads the node again at every step
layout(constant_id = 8) const bool kFromRoot = false;  // descends from the root, not from the grid
layout(constant_id = 9) const bool kCoalesce = true;   // unset: steps over each empty cell by itself
#include "trace/trace_tree.glsl"
