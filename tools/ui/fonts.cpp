#include "tools/ui/fonts.h"

#include "ui_fonts/icons.h"
#include "ui_fonts/roboto.h"

namespace neuvv::ui {

std::span<const unsigned char> roboto_font() {
    return roboto;
}
std::span<const unsigned char> icon_font() {
    return icons;
}

}  // namespace neuvv::ui
