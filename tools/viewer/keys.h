// The keys of the window that belong to no tool, and whom all keys are given to.
#pragma once

#include "tools/viewer/context.h"
#include "tools/viewer/files.h"
#include "tools/viewer/panels/stage_tree.h"
#include "tools/viewer/screenshot.h"
#include "tools/viewer/tools/tools.h"

namespace neuvv::viewer {

struct KeyUses {
    Files& files;
    ui::Window& window;
    Screenshots& screenshots;
    Tools& tools;
    StageTree& tree;
};
// To be called once a frame, between Display::begin and end. While text is typed or a question is open, keys do
// nothing.
void handle_keys(Context& context, const KeyUses& uses);

}  // namespace neuvv::viewer
