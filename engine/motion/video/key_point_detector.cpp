#include "motion/video/key_point_detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "motion/network/network.h"
#include "motion/video/person_crop.h"

namespace neuvv::motion {

namespace {

constexpr uint64_t kLeastSide = 32, kMostSide = 2048;
constexpr const char* kModelHint = "use a model whose output is 1×K×h×w heat maps, or SimCC's 1×K×w and 1×K×h";

struct InputSize {
    uint32_t width = 0, height = 0;  // pixels
};

// The size of the model's one input, 1×3×height×width. The batch may be left open.
InputSize input_size(const OnnxFile& onnx) {
    if (onnx.inputs.size() != 1)
        throw InputError(onnx.name, "graph.input", fmt::format("has {} inputs", onnx.inputs.size()),
                         "use a model that takes one image of one person");
    const std::vector<uint64_t>& shape = onnx.inputs[0].sizes;
    const auto side = [](uint64_t size) { return size >= kLeastSide && size <= kMostSide; };
    if (shape.size() != 4 || shape[0] > 1 || shape[1] != 3 || !side(shape[2]) || !side(shape[3]))
        throw InputError(onnx.name, "graph.input",
                         fmt::format("is {} (0: left open), not 1×3×height×width of {} to {} pixels",
                                     onnx.inputs[0].size_text(), kLeastSide, kMostSide),
                         "export the model with a fixed size of its image");
    return {static_cast<uint32_t>(shape[3]), static_cast<uint32_t>(shape[2])};
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

size_t size_along(const Tensor& output, size_t dimension) {
    return static_cast<size_t>(output.sizes[dimension]);
}

double confidence_of(double value) {
    return value > 0 ? std::min(value, 1.0) : 0;
}

}  // namespace

struct KeyPointDetector::Detector {
    OnnxFile onnx;
    InputSize input;
    PixelScale scale;
    Network network;
    const KeyPointLayout* layout = nullptr;
    std::optional<HeatMaps> maps;  // else lines
    Lines lines;

    Detector(OnnxFile opened, PixelScale wanted)
        : onnx(std::move(opened)), input(input_size(onnx)), scale(wanted), network(onnx) {
        onnx.bytes.clear();
    }

    // Runs the network on a crop of its size, in colours of 0 to 255.
    std::vector<Tensor> run(std::vector<float> rgb) {
        const size_t plane = rgb.size() / 3;
        for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = scaled(rgb[i], i / plane);
        const Tensor image{{1, 3, static_cast<int>(input.height), static_cast<int>(input.width)}, std::move(rgb)};
        std::vector<std::string> outputs;
        for (const OnnxValue& output : onnx.outputs) outputs.push_back(output.name);
        return network.run({{onnx.inputs[0].name, image}}, outputs);
    }

    float scaled(float colour, size_t channel) const {
        constexpr float kMean[] = {123.675f, 116.28f, 103.53f}, kDeviation[] = {58.395f, 57.12f, 57.375f};
        if (scale == PixelScale::kBytes) return colour;
        return scale == PixelScale::kUnit ? colour / 255 : (colour - kMean[channel]) / kDeviation[channel];
    }

    void learn_outputs(const std::vector<Tensor>& outputs) {
        std::string shapes;
        for (const Tensor& output : outputs) shapes += (shapes.empty() ? "" : ", ") + output.size_text();
        const bool known = std::ranges::all_of(outputs, [](const Tensor& output) { return output.sizes[0] == 1; });
        if (known && outputs.size() == 1 && outputs[0].sizes.size() == 4)
            maps = HeatMaps{size_along(outputs[0], 3), size_along(outputs[0], 2)};
        else if (!known || outputs.size() != 2 || outputs[0].sizes.size() != 3 || outputs[1].sizes.size() != 3 ||
                 outputs[0].sizes[1] != outputs[1].sizes[1])
            throw InputError(onnx.name, "graph.output", "is " + shapes, kModelHint);
        else
            learn_lines(outputs);
        const size_t count = size_along(outputs[0], 1);
        layout = find_key_point_layout(count);
        if (!layout)
            throw InputError(onnx.name, "graph.output", fmt::format("is {}: {} key points", shapes, count),
                             "use a model of one of these sets: " + key_point_layouts());
    }

    // Columns come first, unless the input's shape says otherwise.
    void learn_lines(const std::vector<Tensor>& outputs) {
        const size_t first = size_along(outputs[0], 2), second = size_along(outputs[1], 2);
        maps.reset();
        const bool exchanged =
            first * input.width == second * input.height && first * input.height != second * input.width;
        lines = exchanged ? Lines{1, 0, second, first} : Lines{0, 1, first, second};
    }

    // In pixels of the input.
    KeyPoint key_point(const std::vector<Tensor>& outputs, size_t k) const {
        const auto [place, value] = maps ? peak_of_map(outputs, k) : peak_of_lines(outputs, k);
        return {place * glm::dvec2(input.width, input.height), confidence_of(value)};
    }

    // A place is a share of the input's width and height.
    struct Peak {
        glm::dvec2 place{0};
        double value = 0;
    };
    Peak peak_of_map(const std::vector<Tensor>& outputs, size_t k) const {
        const auto [width, height] = *maps;
        const float* map = outputs[0].values.data() + k * width * height;
        const size_t best = greatest(map, width * height), x = best % width, y = best / width;
        const glm::dvec2 at(refined(map + y * width, x, width, 1), refined(map + x, y, height, width));
        return {at / glm::dvec2(width, height), map[best]};
    }
    Peak peak_of_lines(const std::vector<Tensor>& outputs, size_t k) const {
        const float *columns = outputs[lines.columns].values.data() + k * lines.width,
                    *rows = outputs[lines.rows].values.data() + k * lines.height;
        const size_t x = greatest(columns, lines.width), y = greatest(rows, lines.height);
        const glm::dvec2 at(refined(columns, x, lines.width, 1), refined(rows, y, lines.height, 1));
        return {at / glm::dvec2(lines.width, lines.height), std::min(columns[x], rows[y])};
    }
};

KeyPointDetector::KeyPointDetector(const std::filesystem::path& onnx, PixelScale scale)
    : detector_(std::make_unique<Detector>(read_onnx_file(onnx), scale)) {
    const std::vector<float> grey(size_t{3} * detector_->input.width * detector_->input.height, 124);
    detector_->learn_outputs(detector_->run(grey));
}

KeyPointDetector::~KeyPointDetector() = default;

const KeyPointLayout& KeyPointDetector::layout() const {
    return *detector_->layout;
}

std::vector<KeyPoint> KeyPointDetector::detect(const media::Image& image) {
    const std::optional<PixelBox> box = person_box(image);
    if (!box) return {};
    const PersonCrop crop = crop_person(image, *box, detector_->input.width, detector_->input.height);
    const std::vector<Tensor> outputs = detector_->run(crop.rgb);
    detector_->learn_outputs(outputs);  // so that none is read beyond its end, whatever the network does
    std::vector<KeyPoint> points;
    for (size_t k = 0; k < detector_->layout->points; ++k) {
        points.push_back(detector_->key_point(outputs, k));
        points.back().pixel = crop.image_pixel(points.back().pixel);
    }
    return points;
}

}  // namespace neuvv::motion
