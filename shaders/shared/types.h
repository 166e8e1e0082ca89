// Names of scalar and vector types, and macros, with which the headers of this folder compile as C++ and as GLSL.
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
