// `neuvv dataset --as`: a data set written as the files of another layout.
#pragma once

#include "training/data/write_dataset.h"

namespace neuvv::tools {

// Writes the data set as transforms files and images into job.output, whole or not at all, and says what it wrote.
void write_as_transforms(training::WriteJob job);

}  // namespace neuvv::tools
