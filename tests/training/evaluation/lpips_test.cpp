// LPIPS with a tiny network of AlexNet's geometry, against the definition in double precision; unsound weights are
// refused.
#include "training/evaluation/lpips.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "base/formats/npz.h"
#include "support/input_error.h"
#include "support/npz_files.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

using Arrays = std::map<std::string, FloatArray>;

std::string npy_of(const FloatArray& array, const std::string& type = "<f4", const std::string& order = "False") {
    return npy_bytes(type, array.shape, bytes_of(array.values), order);
}

void write_weights(const std::filesystem::path& file, const Arrays& arrays) {
    std::map<std::string, std::string> entries;
    for (const auto& [name, array] : arrays) entries[name] = npy_of(array);
    write_npz(file, entries);
}

struct Convolution {
    std::string name;
    uint32_t in, out, kernel, stride, padding;
    bool pooled;
};
const Convolution kNetwork[] = {{"net.slice1.0", 3, 5, 11, 4, 2, false},
                                {"net.slice2.3", 5, 6, 5, 1, 2, true},
                                {"net.slice3.6", 6, 7, 3, 1, 1, true},
                                {"net.slice4.8", 7, 4, 3, 1, 1, false},
                                {"net.slice5.10", 4, 3, 3, 1, 1, false}};

FloatArray random_array(Random& random, std::vector<uint64_t> shape, double low, double high) {
    size_t count = 1;
    for (const uint64_t extent : shape) count *= extent;
    FloatArray array{std::move(shape), {}};
    for (size_t i = 0; i < count; ++i)
        array.values.push_back(static_cast<float>(low + (high - low) * static_cast<double>(random.below(10001)) / 1e4));
    return array;
}

Arrays random_network() {
    Random random(11);
    Arrays arrays;
    for (size_t i = 0; i < 5; ++i) {
        const Convolution& c = kNetwork[i];
        const double bound = 2.5 / std::sqrt(c.in * c.kernel * c.kernel);
        arrays[c.name + ".weight"] = random_array(random, {c.out, c.in, c.kernel, c.kernel}, -bound, bound);
        arrays[c.name + ".bias"] = random_array(random, {c.out}, -0.1, 0.3);
        arrays["lin" + std::to_string(i) + ".model.1.weight"] = random_array(random, {1, c.out, 1, 1}, 0, 1);
    }
    return arrays;
}

// Numbers by channel, row and column.
using Volume = std::vector<std::vector<std::vector<double>>>;

Volume convolve(const Volume& in, const Convolution& c, const Arrays& arrays) {
    const int height = static_cast<int>(in[0].size()), width = static_cast<int>(in[0][0].size());
    const int k = static_cast<int>(c.kernel), stride = static_cast<int>(c.stride), pad = static_cast<int>(c.padding);
    const int rows = (height + 2 * pad - k) / stride + 1, columns = (width + 2 * pad - k) / stride + 1;
    const FloatArray &weight = arrays.at(c.name + ".weight"), &bias = arrays.at(c.name + ".bias");
    Volume out(c.out, std::vector<std::vector<double>>(static_cast<size_t>(rows),
                                                       std::vector<double>(static_cast<size_t>(columns))));
    for (size_t o = 0; o < c.out; ++o)
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x) {
                double sum = double{bias.values[o]};
                for (size_t i = 0; i < c.in; ++i)
                    for (int v = 0; v < k; ++v)
                        for (int u = 0; u < k; ++u) {
                            const int at_y = y * stride + v - pad, at_x = x * stride + u - pad;
                            if (at_y < 0 || at_x < 0 || at_y >= height || at_x >= width) continue;
                            const size_t w = ((o * c.in + i) * c.kernel + static_cast<size_t>(v)) * c.kernel +
                                             static_cast<size_t>(u);
                            sum +=
                                double{weight.values[w]} * in[i][static_cast<size_t>(at_y)][static_cast<size_t>(at_x)];
                        }
                out[o][static_cast<size_t>(y)][static_cast<size_t>(x)] = std::max(0.0, sum);
            }
    return out;
}

Volume pool(const Volume& in) {
    Volume out(in.size());
    for (size_t c = 0; c < in.size(); ++c)
        for (size_t y = 0; y + 3 <= in[c].size(); y += 2) {
            out[c].emplace_back();
            for (size_t x = 0; x + 3 <= in[c][0].size(); x += 2) {
                double largest = in[c][y][x];
                for (size_t v = 0; v < 3; ++v)
                    for (size_t u = 0; u < 3; ++u) largest = std::max(largest, in[c][y + v][x + u]);
                out[c].back().push_back(largest);
            }
        }
    return out;
}

Volume scaled(const media::Image& image) {
    const double shift[] = {-0.030, -0.088, -0.188}, scale[] = {0.458, 0.448, 0.450};
    Volume out(3, std::vector<std::vector<double>>(image.height, std::vector<double>(image.width)));
    for (size_t c = 0; c < 3; ++c)
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x)
                out[c][y][x] = (image.at(x, y)[c] / 255.0 * 2 - 1 - shift[c]) / scale[c];
    return out;
}

// Scales the features of each pixel to length 1.
void normalise(Volume& volume) {
    for (size_t y = 0; y < volume[0].size(); ++y)
        for (size_t x = 0; x < volume[0][0].size(); ++x) {
            double sum = 0;
            for (const auto& channel : volume) sum += channel[y][x] * channel[y][x];
            for (auto& channel : volume) channel[y][x] /= std::sqrt(sum) + 1e-10;
        }
}

double plain_lpips(const media::Image& a, const media::Image& b, const Arrays& arrays) {
    Volume of_a = scaled(a), of_b = scaled(b);
    double distance = 0;
    for (size_t i = 0; i < 5; ++i) {
        if (kNetwork[i].pooled) of_a = pool(of_a), of_b = pool(of_b);
        of_a = convolve(of_a, kNetwork[i], arrays);
        of_b = convolve(of_b, kNetwork[i], arrays);
        Volume unit_a = of_a, unit_b = of_b;
        normalise(unit_a);
        normalise(unit_b);
        const FloatArray& importance = arrays.at("lin" + std::to_string(i) + ".model.1.weight");
        double sum = 0;
        for (size_t c = 0; c < unit_a.size(); ++c)
            for (size_t y = 0; y < unit_a[c].size(); ++y)
                for (size_t x = 0; x < unit_a[c][y].size(); ++x)
                    sum += double{importance.values[c]} * std::pow(unit_a[c][y][x] - unit_b[c][y][x], 2);
        distance += sum / static_cast<double>(unit_a[0].size() * unit_a[0][0].size());
    }
    return distance;
}

media::Image noise_image(uint32_t width, uint32_t height, uint64_t seed) {
    Random random(seed);
    media::Image image(width, height);
    for (uint8_t& byte : image.rgba) byte = static_cast<uint8_t>(random.below(256));
    return image;
}

struct LpipsTest : ::testing::Test {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "weights.npz";
};

TEST_F(LpipsTest, IsThePlainDefinition) {
    const Arrays arrays = random_network();
    write_weights(file, arrays);
    const training::Lpips lpips(file);
    const struct {
        uint32_t width, height;
    } sizes[] = {{32, 32}, {150, 67}, {91, 134}};  // rows of outputs with full, cut and single strips
    for (const auto& size : sizes) {
        const media::Image a = noise_image(size.width, size.height, 1);
        media::Image b = a;
        for (size_t i = 0; i < b.rgba.size(); i += 3) b.rgba[i] = static_cast<uint8_t>(b.rgba[i] / 2);
        const double expected = plain_lpips(a, b, arrays);
        EXPECT_GT(expected, 0.01);
        EXPECT_NEAR(lpips.distance(a, b), expected, 1e-4 * expected);
        EXPECT_NEAR(lpips.distance(b, a), expected, 1e-4 * expected);
        EXPECT_EQ(lpips.distance(a, a), 0);
    }
    expect_input_error([&] { lpips.distance(noise_image(31, 40, 1), noise_image(31, 40, 2)); }, {"31×40", "lpips: "});
}

TEST_F(LpipsTest, OtherArraysAreIgnoredButNoneMayLackOrBeMisshapen) {
    const Arrays good = random_network();
    Arrays more = good;
    more["scaling_layer.shift"] = {{1, 3, 1, 1}, {0, 0, 0}};
    write_weights(file, more);
    EXPECT_NO_THROW(training::Lpips{file});
    for (const auto& [name, array] : good) {
        Arrays bad = good;
        bad.erase(name);
        write_weights(file, bad);
        expect_input_error([&] { training::Lpips{file}; }, {"weights.npz", name, "missing"});
        bad[name] = {{2, 3}, std::vector<float>(6)};
        write_weights(file, bad);
        expect_input_error([&] { training::Lpips{file}; }, {"weights.npz", "shape"});
    }
}

TEST_F(LpipsTest, DamagedFilesAreBadInput) {
    expect_input_error([&] { read_npz(folder.path / "missing.npz"); }, {"missing.npz"});
    write_text(file, "no zip");
    expect_input_error([&] { read_npz(file); }, {"weights.npz"});
    const FloatArray array{{2, 2}, {1, 2, 3, 4}};
    const std::string whole = npy_of(array);
    const struct {
        std::string bytes, problem;
    } cases[] = {{npy_of(array, "<f8"), "its shape 32"},
                 {npy_of(array, "|O"), "little-endian"},
                 {npy_of(array, "<f4", "True"), "C order"},
                 {whole.substr(0, whole.size() - 1), "its shape 16"},
                 {whole + "x", "its shape 16"},
                 {whole.substr(0, 30), "header"},
                 {"", "no .npy"},
                 {npy_of({{4000000000u, 4000000000u, 4000000000u}, {}}), "shape"}};
    for (const auto& c : cases) {
        write_npz(file, {{"a", c.bytes}});
        expect_input_error([&] { read_npz(file); }, {"weights.npz", "a", c.problem});
    }
    write_weights(file, {{"numbers", array}});
    EXPECT_EQ(read_npz(file).at("numbers").values, array.values);
    EXPECT_EQ(read_npz(file).at("numbers").shape, array.shape);
    std::string flipped = read_text(file);
    flipped[flipped.find("NUMPY") + 100] ^= 1;
    write_text(file, flipped);
    expect_input_error([&] { read_npz(file); }, {"weights.npz"});
}

}  // namespace
}  // namespace neuvv::test
