// Which profile of long arrays (buffer_profile.h) is faster on a device: timed at the first start on it, then kept in a
// file of the user's cache folder.
#pragma once

#include <filesystem>
#include <optional>

#include "gpu/buffer_profile.h"

namespace neuvv::gpu {

class Device;
struct DeviceSummary;

// The file of a device, its driver and this version of the program; empty where there is no cache folder.
std::filesystem::path profile_times_file(const DeviceSummary& device);

// What the file says; nothing where there is none, or where it is damaged or of another device, driver or version.
std::optional<ProfileTimes> read_profile_times(const std::filesystem::path& file, const DeviceSummary& device);
// Without the file the next start measures again; nothing else is lost where it cannot be written.
void write_profile_times(const std::filesystem::path& file, const DeviceSummary& device, const ProfileTimes& times);

// Times the reads of shaders/buffer_speed.comp by both: some milliseconds on a GPU, and compiling two shaders.
ProfileTimes measure_profiles(const Device& device);

// Texel buffers, unless storage buffers are faster by more than measurements differ.
BufferProfile faster(const ProfileTimes& times);

// Where speed decides, takes the profile of the times that are kept, and with a device measures them if there are none.
// Where the device has no memory for that, texel buffers remain.
void choose_by_kept_times(DeviceSummary& summary);
void choose_by_speed(const Device& device, DeviceSummary& summary);

}  // namespace neuvv::gpu
