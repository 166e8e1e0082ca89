// Runs a network of an ONNX file that the user names, by OpenCV on the processor.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "motion/network/onnx_file.h"

namespace neuvv::motion {

struct Tensor {
    std::vector<int> sizes;     // at least one, each at least 1
    std::vector<float> values;  // of the last size first

    std::string size_text() const;  // "1×3×480×640"
};

// A network is a program that OpenCV runs: open only those that you trust.
class Network {
  public:
    // Throws InputError where the file has operations that OpenCV lacks.
    explicit Network(const OnnxFile& onnx);
    ~Network();
    Network(const Network&) = delete;
    Network& operator=(const Network&) = delete;

    // The outputs of these names, for these inputs by name. Tensors must have as many values as their sizes say
    // (assert). Throws InputError where the network cannot be run, or gives anything but single precision.
    std::vector<Tensor> run(const std::map<std::string, Tensor>& inputs, const std::vector<std::string>& outputs);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace neuvv::motion
