// Under AddressSanitizer: what Vulkan drivers and layers, and the OpenXR loader, keep to themselves is no leak of ours.
#ifdef __SANITIZE_ADDRESS__

// They stay loaded, so that the check at the end can tell their frames by the name of their file.
extern "C" int dlclose(void*) {
    return 0;
}

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libLLVM\nleak:libvulkan\nleak:libVkLayer\nleak:libopenxr_loader\n";
}

#endif
