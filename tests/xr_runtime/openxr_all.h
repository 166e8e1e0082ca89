// The OpenXR and Vulkan headers as the runtime needs them: no prototypes, since it implements the one's functions and
// loads the other's through the application.
#pragma once

#include <ctime>

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>
#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_VULKAN
#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>
#include <openxr/openxr_reflection.h>
