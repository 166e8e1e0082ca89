// Which network of mattes a file has, by the names of its inputs and outputs.
#include "training/mattes/matte_model.h"

#include <gtest/gtest.h>

#include "support/input_error.h"

namespace neuvv::test {
namespace {

using training::find_matte_model;
using Values = std::vector<motion::OnnxValue>;

motion::OnnxFile file_of(const Values& inputs, const Values& outputs) {
    return {.name = "a.onnx", .bytes = {}, .inputs = inputs, .outputs = outputs};
}

const Values kOpenStates{{"r1i", {0, 0, 0, 0}}, {"r2i", {0, 0, 0, 0}}, {"r3i", {0, 0, 0, 0}}, {"r4i", {0, 0, 0, 0}}};
const Values kRecurrent{{"fgr", {0, 3, 0, 0}}, {"pha", {0, 1, 0, 0}}, {"r1o", {}},
                        {"r2o", {}},           {"r3o", {}},           {"r4o", {}}};

Values with(Values values, const Values& more) {
    values.insert(values.end(), more.begin(), more.end());
    return values;
}

std::string name_of(const Values& inputs, const Values& outputs) {
    const training::MatteModel model = find_matte_model(file_of(inputs, outputs));
    return model.is_known ? model.family->name : "unknown";
}

TEST(MatteModel, IsKnownByItsNamesAndSizes) {
    const Values src{{"src", {0, 3, 0, 0}}};
    EXPECT_EQ(name_of(with(with(src, kOpenStates), {{"downsample_ratio", {1}}}), kRecurrent), "Robust Video Matting");
    EXPECT_EQ(name_of(with(src, kOpenStates), kRecurrent), "Robust Video Matting");
    EXPECT_EQ(name_of({{"src", {1, 3, 720, 1280}}, {"bgr", {1, 3, 720, 1280}}}, {{"pha", {}}, {"fgr", {}}}),
              "Background Matting V2");
    EXPECT_EQ(name_of({{"input", {0, 3, 0, 0}}}, {{"output", {0, 1, 0, 0}}}), "MODNet");
    EXPECT_EQ(name_of({{"input", {1, 3, 1024, 1024}}}, {{"output", {1, 1, 1024, 1024}}}), "MODNet");
    EXPECT_EQ(name_of({{"input.1", {1, 3, 320, 320}}}, {{"1959", {}}, {"1960", {}}}), "U²-Net");
    EXPECT_EQ(name_of({{"input", {0, 3, 320, 320}}}, {{"output", {}}}), "U²-Net");
    EXPECT_EQ(name_of({{"input", {1, 3, 1024, 1024}}}, {{"2000", {}}, {"2001", {}}}), "IS-Net");
    EXPECT_EQ(name_of({{"input_image", {1, 3, 1024, 1024}}}, {{"output_image", {1, 1, 1024, 1024}}}), "BiRefNet");
    EXPECT_EQ(name_of({{"x", {1, 3, 256, 192}}}, {{"y", {1, 1, 256, 192}}}), "unknown");
    EXPECT_EQ(name_of({{"x", {0, 3, 0, 0}}}, {{"y", {0, 0, 0}}}), "unknown");
}

TEST(MatteModel, IsRefusedWithWhatItHas) {
    const auto refuse = [](const Values& inputs, const Values& outputs, std::initializer_list<std::string> parts) {
        expect_input_error([&] { find_matte_model(file_of(inputs, outputs)); }, parts);
    };
    const Values y{{"y", {1, 1, 8, 8}}}, image{{"x", {1, 3, 8, 8}}};
    refuse({}, y, {"a.onnx", "takes nothing"});
    refuse(image, {},
           {"gives nothing", "Robust Video Matting, Background Matting V2, BiRefNet, U²-Net, MODNet, IS-Net"});
    refuse({{"x", {1, 3, 8, 8}}, {"z", {1, 5}}}, y, {"x 1×3×8×8, z 1×5", "y 1×1×8×8"});
    refuse({{"x", {2, 3, 8, 8}}}, y, {"x 2×3×8×8"});
    refuse({{"x", {1, 8, 8, 3}}}, y, {"x 1×8×8×3"});
    refuse({{"x", {1, 3, 8, 100000}}}, y, {"x 1×3×8×100000"});
    refuse(image, {{"y", {1, 2, 8, 8}}}, {"y 1×2×8×8"});
    refuse(image, {{"y", {1, 1, 8, 8}}, {"z", {1, 1, 8, 8}}}, {"y 1×1×8×8, z"});
    // A state whose output is lacking, and an input that the family does not have.
    refuse(with({{"src", {0, 3, 0, 0}}}, kOpenStates), {{"pha", {}}, {"r1o", {}}},
           {"r4i 0×0×0×0", "r1o without sizes"});
    refuse(with(with({{"src", {0, 3, 0, 0}}}, kOpenStates), {{"odd", {1}}}), kRecurrent, {"odd 1"});
}

TEST(MatteModel, SeesTheSizeThatItsFamilyIsFor) {
    const media::ImageSize wide{1920, 1080}, small{300, 400};
    const auto model = [](const char* input, const char* output, uint64_t height, uint64_t width) {
        return find_matte_model(file_of({{input, {1, 3, height, width}}}, {{output, {1, 1, height, width}}}));
    };
    EXPECT_EQ(model("input", "output", 0, 0).seen_size(wide), (media::ImageSize{896, 512}));
    EXPECT_EQ(model("input", "output", 0, 0).seen_size(small), (media::ImageSize{512, 672})) << "enlarged";
    EXPECT_EQ(model("input", "output", 0, 0).seen_size({480, 640}), (media::ImageSize{480, 640}));
    EXPECT_EQ(model("input", "output", 288, 512).seen_size(wide), (media::ImageSize{512, 288}));
    EXPECT_EQ(model("x", "y", 0, 0).seen_size(wide), (media::ImageSize{1024, 576}));
    EXPECT_EQ(model("x", "y", 0, 0).seen_size(small), (media::ImageSize{288, 416}));
    const training::MatteModel recurrent =
        find_matte_model(file_of(with({{"src", {0, 3, 0, 0}}}, kOpenStates), kRecurrent));
    EXPECT_EQ(recurrent.seen_size({1921, 1079}), (media::ImageSize{1921, 1079}));
    const training::MatteModel plate =
        find_matte_model(file_of({{"src", {0, 3, 0, 0}}, {"bgr", {0, 3, 0, 0}}}, {{"pha", {}}}));
    EXPECT_EQ(plate.seen_size({1921, 1079}), (media::ImageSize{1920, 1080}));
}

}  // namespace
}  // namespace neuvv::test
