// Tests on the device: one Device a process, with the validation layers on; a validation message fails the test.
#pragma once

#include <gtest/gtest.h>

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
    }
};

}  // namespace neuvv::test
