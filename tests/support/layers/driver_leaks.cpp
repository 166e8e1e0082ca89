// For AddressSanitizer: memory that Vulkan drivers, layers and the OpenXR loader never free is not reported as a leak.
#ifdef __SANITIZE_ADDRESS__

// Libraries stay loaded, so that the leak check at the end can recognise their stack frames by the library's name.
extern "C" int dlclose(void*) {
    return 0;
}

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libLLVM\nleak:libvulkan\nleak:libVkLayer\nleak:libopenxr_loader\n";
}

#endif
