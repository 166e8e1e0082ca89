// gradient_add(): atomic addition to the floats of `gradients`, native or (with NEUVV_CAS_ATOMICS) by compare and swap.
// The file that includes this one defines NEUVV_GRADIENTS_BINDING.
#ifdef NEUVV_CAS_ATOMICS
layout(binding = NEUVV_GRADIENTS_BINDING, std430) buffer Gradients { uint gradients[]; };

void gradient_add(uint index, float value) {
    uint seen = gradients[index], expected;
    do {
        expected = seen;
        seen = atomicCompSwap(gradients[index], expected, floatBitsToUint(uintBitsToFloat(expected) + value));
    } while (seen != expected);
}
#else
layout(binding = NEUVV_GRADIENTS_BINDING, std430) buffer Gradients { float gradients[]; };

void gradient_add(uint index, float value) { atomicAdd(gradients[index], value); }
#endif
