// The environment of a stage: an equirectangular image whose centre is towards −Z and whose top is +Y, rotated about
// +Y. Mip level i is blurred as a surface of roughness i / last mirrors the image. The includer declares
//   uniform Lights { ShaderLights lights; };  uniform sampler2D environment;
#ifndef NEUVV_ENVIRONMENT_GLSL
#define NEUVV_ENVIRONMENT_GLSL
#include "shared/lights.h"

vec3 environment_at(vec3 dir, float roughness) {
    const float c = lights.environment.z, s = lights.environment.w;
    const vec3 turned = vec3(c * dir.x - s * dir.z, dir.y, s * dir.x + c * dir.z);
    const vec2 uv = vec2(0.5 + atan(turned.x, -turned.z) / 6.28318530717959,
                         acos(clamp(turned.y, -1.0, 1.0)) / 3.14159265358979);
    return lights.environment.x * textureLod(environment, uv, roughness * lights.environment.y).rgb;
}

#endif
