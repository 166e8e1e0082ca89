// direct_adjoint.glsl for devices without atomic float addition, by compare and swap. It is a module of its own because
// a device must support every capability that a SPIR-V module declares, used or not.
#version 460
#extension GL_GOOGLE_include_directive : require
#define NEUVV_CAS_ATOMICS
#include "direct_adjoint.glsl"
