#include "motion/network/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "base/error.h"

namespace neuvv::motion {

namespace {

// OpenCV's text as part of a line.
std::string part_of_line(const std::string& text) {
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
    throw InputError(file, "", fmt::format("{}: {}", what, part_of_line(problem)),
                     "OpenCV 4.6 may lack its operations; export the model anew with opset 11 and fixed sizes, or use "
                     "another one");
}

Tensor tensor_of(const cv::Mat& output, const std::string& name, const std::string& file) {
    if (output.type() != CV_32F || output.dims < 1 || output.total() == 0)
        throw InputError(file, "graph.output", name + " is empty, or not in single precision",
                         "export the model in single precision");
    const cv::Mat whole = output.isContinuous() ? output : output.clone();
    return {.sizes = {whole.size.p, whole.size.p + whole.dims},
            .values = {whole.ptr<float>(), whole.ptr<float>() + whole.total()}};
}

}  // namespace

std::string Tensor::size_text() const {
    return fmt::format("{}", fmt::join(sizes, "×"));
}

struct Network::State {
    std::string file;
    cv::dnn::Net net;
};

Network::Network(const OnnxFile& onnx) : state_(std::make_unique<State>()) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    state_->file = onnx.name;
    with_opencv(onnx.name, "cannot be opened", [&] {
        state_->net = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(onnx.bytes.data()), onnx.bytes.size());
    });
}

Network::~Network() = default;

std::vector<Tensor> Network::run(const std::map<std::string, Tensor>& inputs, const std::vector<std::string>& outputs) {
    const std::vector<cv::Mat> found = with_opencv(state_->file, "cannot be run", [&] {
        for (const auto& [name, tensor] : inputs) {
            // OpenCV copies the values.
            const cv::Mat blob(tensor.sizes, CV_32F, const_cast<float*>(tensor.values.data()));
            assert(blob.total() == tensor.values.size() && "as many values as the sizes say");
            state_->net.setInput(blob, name);
        }
        std::vector<cv::Mat> made;
        state_->net.forward(made, outputs);
        return made;
    });
    if (found.size() != outputs.size())
        throw InputError(state_->file, "graph.output", fmt::format("gives {} of {}", found.size(), outputs.size()),
                         "export the model anew");
    std::vector<Tensor> tensors;
    for (size_t i = 0; i < found.size(); ++i) tensors.push_back(tensor_of(found[i], outputs[i], state_->file));
    return tensors;
}

}  // namespace neuvv::motion
