// Lets one header serve C++ and GLSL: the shared names of scalar and vector types.
#ifndef NEUVV_SHARED_TYPES_H
#define NEUVV_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
#define NEUVV_SHARED namespace neuvv {
#define NEUVV_SHARED_END }
#define CONSTEXPR constexpr
namespace neuvv {
using uint = uint32_t;
using glm::mat4;
using glm::uvec4;
using glm::vec4;
}  // namespace neuvv
#else
#define NEUVV_SHARED
#define NEUVV_SHARED_END
#define CONSTEXPR const
#endif

#endif
