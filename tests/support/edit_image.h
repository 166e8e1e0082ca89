// Changes to the images of a data set in memory.
#pragma once

#include "training/data/dataset.h"

namespace neuvv::test {

// edit(image) gets the view's pixels as a media::Image, and changes them.
template <typename Edit>
void edit_image(training::View& view, const Edit& edit) {
    media::Image image = view.image.whole();
    edit(image);
    view.image.store(image);
}

inline void clear_image(training::View& view) {
    view.image.store(media::Image(view.image.width(), view.image.height()));
}

}  // namespace neuvv::test
