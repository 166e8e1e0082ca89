// The base class of tests on the device. They share one Device with validation layers; a validation message or a record
// of debug_print fails the test.
#pragma once

#include <gtest/gtest.h>

#include "gpu/debug_buffer.h"
#include "gpu/device.h"

namespace neuvv::test {

class GpuTest : public ::testing::Test {
  protected:
    static const gpu::Device& device() {
        static const gpu::Device shared("", gpu::Validation::kOn);
        return shared;
    }
    void TearDown() override {
        for (const std::string& message : device().drain_validation_messages()) ADD_FAILURE() << message;
        if (gpu::DebugBuffer* debug = device().used_debug_buffer()) {
            uint64_t lost = 0;
            for (const DebugRecord& record : debug->drain(lost)) ADD_FAILURE() << "a shader: " << gpu::text_of(record);
            EXPECT_EQ(lost, 0u) << "further records had no room";
        }
    }
};

}  // namespace neuvv::test
