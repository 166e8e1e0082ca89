// Runs a network of mattes on one image after another.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "motion/network/network.h"
#include "training/mattes/matte_model.h"

namespace neuvv::training {

class MatteNetwork {
  public:
    // Throws InputError as read_onnx_file(), find_matte_model() and Network do.
    explicit MatteNetwork(const std::filesystem::path& file);

    bool wants_plate() const { return model_.wants_plate(); }

    // What the frames before leave for the next one of a camera, by the network's inputs. Empty: there are none.
    using Memory = std::map<std::string, motion::Tensor>;

    // The alpha of each pixel of an image, row by row. The plate has the image's size (assert); only a network that
    // wants one reads it. `name` is the image's, for errors. Throws InputError where the network cannot be run, where
    // its alpha has not the size of what it sees, is not a number, or is far from 0 to 1.
    std::vector<uint8_t> matte_of(const media::Image& image, const media::Image& plate, Memory& memory,
                                  const std::string& name);

  private:
    motion::Tensor seen(const media::Image& image) const;
    motion::Tensor first_state(const motion::OnnxValue& input) const;
    std::vector<uint8_t> alpha_bytes(motion::Tensor alpha, media::ImageSize seen, media::ImageSize image,
                                     const std::string& name) const;

    std::string file_;
    MatteModel model_;
    motion::Network network_;

    explicit MatteNetwork(const motion::OnnxFile& onnx);
};

}  // namespace neuvv::training
