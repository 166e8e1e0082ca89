#include "voctree/files/half.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random_tree.h"

namespace neuvv {
namespace {

// The value of 16 bits by the definition of binary16.
double value_of_half(uint32_t bits) {
    const double sign = bits & 0x8000 ? -1 : 1;
    const int exponent = static_cast<int>(bits >> 10 & 31);
    const double mantissa = bits & 1023;
    if (exponent == 31) return mantissa == 0 ? sign * INFINITY : NAN;
    return sign * (exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25));
}

TEST(Half, ToFloatIsExactForAll65536) {
    for (uint32_t bits = 0; bits < 65536; ++bits) {
        const float value = voctree::float_from_half(static_cast<uint16_t>(bits));
        const double truth = value_of_half(bits);
        if (std::isnan(truth))
            ASSERT_TRUE(std::isnan(value)) << bits;
        else
            ASSERT_EQ(truth, value) << bits;
        ASSERT_EQ(bits >> 15 == 1, std::signbit(value)) << bits;
    }
}

TEST(Half, EveryFiniteHalfSurvivesTheRoundTrip) {
    for (uint32_t bits = 0; bits < 65536; ++bits) {
        if ((bits & 0x7c00) == 0x7c00) continue;
        ASSERT_EQ(bits, voctree::half_from_float(voctree::float_from_half(static_cast<uint16_t>(bits))));
    }
}

// Between any two neighbouring halves, the midpoint rounds to the even one, and its float neighbours to the nearer one.
TEST(Half, RoundsToNearestTiesToEven) {
    for (uint32_t low = 0; low < 0x7bff; ++low) {
        const uint32_t even = low % 2 == 0 ? low : low + 1;
        const auto centre = static_cast<float>((value_of_half(low) + value_of_half(low + 1)) / 2);
        ASSERT_EQ(even, voctree::half_from_float(centre)) << low;
        ASSERT_EQ(even | 0x8000, voctree::half_from_float(-centre)) << low;
        ASSERT_EQ(low, voctree::half_from_float(std::nextafter(centre, 0.0f))) << low;
        ASSERT_EQ(low + 1, voctree::half_from_float(std::nextafter(centre, 1e6f))) << low;
    }
}

#ifdef __FLT16_MANT_DIG__
TEST(Half, AgreesWithTheCompilersFloat16) {
    test::Random random(7);
    for (int i = 0; i < 2'000'000; ++i) {
        const auto bits = static_cast<uint32_t>(random.engine());
        const float value = std::bit_cast<float>(bits);
        if (!(std::fabs(value) < 65520.0f)) continue;
        ASSERT_EQ(std::bit_cast<uint16_t>(static_cast<_Float16>(value)), voctree::half_from_float(value)) << value;
    }
}
#endif

TEST(Half, SaturatesAndKeepsNan) {
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float large : {65504.0f, 65519.0f, 65520.0f, 1e6f, 3e38f, infinity}) {
        EXPECT_EQ(0x7bff, voctree::half_from_float(large)) << large;
        EXPECT_EQ(0xfbff, voctree::half_from_float(-large)) << large;
    }
    EXPECT_TRUE(
        std::isnan(voctree::float_from_half(voctree::half_from_float(std::numeric_limits<float>::quiet_NaN()))));
    EXPECT_EQ(0, voctree::half_from_float(1e-40f));
    EXPECT_EQ(0x8000, voctree::half_from_float(-0.0f));
}

}  // namespace
}  // namespace neuvv
