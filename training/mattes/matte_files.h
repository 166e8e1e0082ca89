// Writes mattes as files, and the sheet by which a person judges them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "media/image.h"

namespace neuvv::training {

// The name of the sheet, which no image may have.
constexpr const char* kMatteSheetName = "contact_sheet";

class MatteFiles {
  public:
    explicit MatteFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // Writes folder/NAME.png, 8-bit grey: the matte has a byte per pixel of the image. The first image of a camera goes
    // onto the sheet. Throws RuntimeFailure where the file cannot be written. Not from several threads at once.
    void add(const std::string& camera, const std::string& name, const media::Image& image,
             const std::vector<uint8_t>& matte);
    // Writes folder/contact_sheet.png: of each camera the image, its matte, and the performer over magenta; first the
    // cameras that stand in `first`. Returns the cameras by row; nothing is written where no matte was added.
    std::vector<std::string> write_sheet(const std::vector<std::string>& first = {}) const;

    uint64_t count() const { return count_; }
    // Whether any pixel of any matte is more than half performer.
    bool shows_performer() const { return shows_performer_; }
    // The mean share of white along the borders of the images.
    double white_borders() const { return count_ > 0 ? white_borders_ / static_cast<double>(count_) : 0; }

  private:
    std::filesystem::path folder_;
    uint64_t count_ = 0;
    bool shows_performer_ = false;
    double white_borders_ = 0;                               // the sum over all mattes
    std::vector<std::string> cameras_;                       // in the order of their first images
    std::map<std::string, std::vector<media::Image>> rows_;  // of the sheet
};

}  // namespace neuvv::training
