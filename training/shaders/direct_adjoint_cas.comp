// direct_adjoint.glsl for devices without atomic float addition: compare and swap. Its own module, because a SPIR-V
// module that names a capability needs it, used or not.
#version 460
#extension GL_GOOGLE_include_directive : require
#define NEUVV_CAS_ATOMICS
#include "direct_adjoint.glsl"
