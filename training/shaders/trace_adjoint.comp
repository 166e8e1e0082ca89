// trace_adjoint.glsl for devices that have atomic float addition.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_atomic_float : require
#include "trace_adjoint.glsl"
