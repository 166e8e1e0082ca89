#include "motion/video/key_point_detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <optional>
#include <span>

#include "base/error.h"
#include "base/platform.h"
#include "motion/video/onnx_input.h"
#include "motion/video/person_crop.h"

namespace neuvv::motion {

namespace {

constexpr uint64_t kMaxModelBytes = uint64_t{1} << 31;  // what protobuf reads
constexpr const char* kModelHint = "use a model whose output is 1×K×h×w heat maps, or SimCC's 1×K×w and 1×K×h";

// OpenCV's text as part of a line.
std::string one_line(const std::string& text) {
    std::string line = text.substr(0, 160);
    std::ranges::replace_if(
        line, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    return line;
}

// Runs OpenCV. Whatever it throws becomes one InputError.
template <typename Work>
auto with_opencv(const std::string& file, const char* what, Work&& work) {
    std::string problem;
    try {
        return work();
    } catch (const cv::Exception& error) {
        problem = error.err;
    } catch (const std::exception& error) {
        problem = error.what();
    }
    throw InputError(file, "", fmt::format("{}: {}", what, one_line(problem)),
                     "OpenCV 4.6 may lack its operations; export the model anew with opset 11, or use another one");
}

// Where a peak is from the middle one of three values: −½ to ½. Networks learn Gaussians, whose logarithms are
// parabolas.
double peak_offset(double before, double here, double after) {
    if (std::min({before, here, after}) > 0) before = std::log(before), here = std::log(here), after = std::log(after);
    const double bend = before - 2 * here + after;
    const double offset = bend < 0 ? 0.5 * (before - after) / bend : 0;
    return std::isfinite(offset) ? std::clamp(offset, -0.5, 0.5) : 0;
}

// Which of the values is the greatest; NaN is none.
size_t greatest(const float* values, size_t count) {
    size_t best = 0;
    for (size_t i = 1; i < count; ++i)
        if (values[i] > values[best] || std::isnan(values[best])) best = i;
    return best;
}

// Where the peak around value `at` of `count` is that are `stride` apart; the centre of the first one is ½.
double refined(const float* values, size_t at, size_t count, size_t stride) {
    const double centre = static_cast<double>(at) + 0.5;
    if (at == 0 || at + 1 == count) return centre;
    return centre + peak_offset(values[(at - 1) * stride], values[at * stride], values[(at + 1) * stride]);
}

struct HeatMaps {
    size_t width = 0, height = 0;
};
struct Lines {
    size_t columns = 0, rows = 1;  // which output is which
    size_t width = 0, height = 0;
};

size_t size_along(const cv::Mat& output, int dimension) {
    return static_cast<size_t>(output.size[dimension]);
}

double confidence_of(double value) {
    return value > 0 ? std::min(value, 1.0) : 0;
}

}  // namespace

struct KeyPointDetector::Network {
    std::string file;
    OnnxInput input;
    PixelScale scale;
    cv::dnn::Net net;
    std::vector<cv::String> names;
    const KeyPointLayout* layout = nullptr;
    std::optional<HeatMaps> maps;  // else lines
    Lines lines;

    // Runs the network on a crop of its size, in colours of 0 to 255.
    std::vector<cv::Mat> run(std::vector<float> rgb) {
        const size_t plane = rgb.size() / 3;
        for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = scaled(rgb[i], i / plane);
        const int sizes[] = {1, 3, static_cast<int>(input.height), static_cast<int>(input.width)};
        return with_opencv(file, "cannot be run", [&] {
            net.setInput(cv::Mat(4, sizes, CV_32F, rgb.data()));
            std::vector<cv::Mat> outputs;
            net.forward(outputs, names);
            return outputs;
        });
    }

    float scaled(float colour, size_t channel) const {
        constexpr float kMean[] = {123.675f, 116.28f, 103.53f}, kDeviation[] = {58.395f, 57.12f, 57.375f};
        if (scale == PixelScale::kBytes) return colour;
        return scale == PixelScale::kUnit ? colour / 255 : (colour - kMean[channel]) / kDeviation[channel];
    }

    void learn_outputs(const std::vector<cv::Mat>& outputs) {
        std::string shapes;
        for (const cv::Mat& output : outputs) {
            if (!shapes.empty()) shapes += ", ";
            for (int d = 0; d < output.dims; ++d) shapes += fmt::format("{}{}", d > 0 ? "×" : "", output.size[d]);
        }
        const bool known = std::ranges::all_of(outputs, [](const cv::Mat& output) {
            return output.type() == CV_32F && output.isContinuous() && output.total() > 0 && output.size[0] == 1;
        });
        if (known && outputs.size() == 1 && outputs[0].dims == 4)
            maps = HeatMaps{size_along(outputs[0], 3), size_along(outputs[0], 2)};
        else if (!known || outputs.size() != 2 || outputs[0].dims != 3 || outputs[1].dims != 3 ||
                 outputs[0].size[1] != outputs[1].size[1])
            throw InputError(file, "graph.output", "is " + shapes, kModelHint);
        else
            learn_lines(outputs);
        const size_t count = size_along(outputs[0], 1);
        layout = find_key_point_layout(count);
        if (!layout)
            throw InputError(file, "graph.output", fmt::format("is {}: {} key points", shapes, count),
                             "use a model of one of these sets: " + key_point_layouts());
    }

    // Columns come first, unless the input's shape says otherwise.
    void learn_lines(const std::vector<cv::Mat>& outputs) {
        const size_t first = size_along(outputs[0], 2), second = size_along(outputs[1], 2);
        maps.reset();
        const bool exchanged =
            first * input.width == second * input.height && first * input.height != second * input.width;
        lines = exchanged ? Lines{1, 0, second, first} : Lines{0, 1, first, second};
    }

    // In pixels of the input.
    KeyPoint key_point(const std::vector<cv::Mat>& outputs, size_t k) const {
        const auto [place, value] = maps ? peak_of_map(outputs, k) : peak_of_lines(outputs, k);
        return {place * glm::dvec2(input.width, input.height), confidence_of(value)};
    }

    // A place is a share of the input's width and height.
    struct Peak {
        glm::dvec2 place{0};
        double value = 0;
    };
    Peak peak_of_map(const std::vector<cv::Mat>& outputs, size_t k) const {
        const auto [width, height] = *maps;
        const float* map = outputs[0].ptr<float>() + k * width * height;
        const size_t best = greatest(map, width * height), x = best % width, y = best / width;
        const glm::dvec2 at(refined(map + y * width, x, width, 1), refined(map + x, y, height, width));
        return {at / glm::dvec2(width, height), map[best]};
    }
    Peak peak_of_lines(const std::vector<cv::Mat>& outputs, size_t k) const {
        const float *columns = outputs[lines.columns].ptr<float>() + k * lines.width,
                    *rows = outputs[lines.rows].ptr<float>() + k * lines.height;
        const size_t x = greatest(columns, lines.width), y = greatest(rows, lines.height);
        const glm::dvec2 at(refined(columns, x, lines.width, 1), refined(rows, y, lines.height, 1));
        return {at / glm::dvec2(lines.width, lines.height), std::min(columns[x], rows[y])};
    }
};

KeyPointDetector::KeyPointDetector(const std::filesystem::path& onnx, PixelScale scale)
    : network_(std::make_unique<Network>()) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    const std::vector<uint8_t> bytes = read_file(onnx, kMaxModelBytes);
    network_->file = onnx.string();
    network_->input = read_onnx_input(bytes, network_->file);
    network_->scale = scale;
    with_opencv(network_->file, "cannot be opened", [&] {
        network_->net = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        network_->names = network_->net.getUnconnectedOutLayersNames();
    });
    const std::vector<float> grey(size_t{3} * network_->input.width * network_->input.height, 124);
    network_->learn_outputs(network_->run(grey));
}

KeyPointDetector::~KeyPointDetector() = default;

const KeyPointLayout& KeyPointDetector::layout() const {
    return *network_->layout;
}

std::vector<KeyPoint> KeyPointDetector::detect(const media::Image& image) {
    const std::optional<PixelBox> box = person_box(image);
    if (!box) return {};
    const PersonCrop crop = crop_person(image, *box, network_->input.width, network_->input.height);
    const std::vector<cv::Mat> outputs = network_->run(crop.rgb);
    network_->learn_outputs(outputs);  // so that none is read beyond its end, whatever the network does
    std::vector<KeyPoint> points;
    for (size_t k = 0; k < network_->layout->points; ++k) {
        points.push_back(network_->key_point(outputs, k));
        points.back().pixel = crop.image_pixel(points.back().pixel);
    }
    return points;
}

}  // namespace neuvv::motion
