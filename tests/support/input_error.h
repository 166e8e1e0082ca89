// Expects that a call throws an InputError of one line that contains all of `parts`.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "base/error.h"

namespace neuvv {

template <typename Call>
void expect_input_error(Call&& call, std::initializer_list<std::string> parts) {
    std::string text;
    try {
        call();
    } catch (const InputError& error) {
        text = error.what();
    }
    ASSERT_FALSE(text.empty()) << "no InputError";
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_LT(text.size(), 1000u) << text;
    for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " not in: " << text;
}

}  // namespace neuvv
