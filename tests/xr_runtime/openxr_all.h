// The OpenXR and Vulkan headers without prototypes: the runtime implements OpenXR's functions, and loads Vulkan's
// through the application.
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

#include "xr/body_tracking_types.h"
#include "xr/newer_types.h"
