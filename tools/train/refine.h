// What `neuvv train --refine` and `neuvv dataset --rig` have in common: the search for errors of a rig, and what is
// said of them.
#pragma once

#include <optional>
#include <string>

#include "training/data/layouts/rig/rig.h"
#include "training/run/rig_search.h"

namespace neuvv::tools {

// What of the cameras is learnt.
struct Refine {
    training::Refinement what;
    bool automatic = false;      // what is worth it by the findings of the search
    bool tries_colours = false;  // TrainSettings::try_colours

    // Whether the user asked for anything.
    bool is_asked() const { return needs_search() || (what.colour.any() && !tries_colours); }
    bool needs_search() const { return automatic || what.poses || what.time; }
};

// Reads names after commas: "colour,poses", "auto", "none"; empty: colours are tried. Throws InputError for others.
Refine refine_of(const std::string& text);

// Searches with a status line; looks at colours as `colour` says, and at poses where cameras may move. Ctrl-C ends the
// search with what it has found so far; nothing where that is nothing.
std::optional<training::RigFindings> search_rig(const gpu::Device& device, const training::Dataset& dataset,
                                                training::TrainSettings settings, training::ColourRefinement colour,
                                                bool move_cameras);

// Searches, and sets what `settings` correct and learn; takes the time that this took off their budget in minutes.
// False where Ctrl-C stopped it before anything was found.
bool correct_rig(const gpu::Device& device, const training::Dataset& dataset, const Refine& refine,
                 training::TrainSettings& settings);

// Prints what a run learnt of its cameras: a line for each that is off.
void print_corrections(const training::TrainProgress& last, const std::vector<training::RigCamera>& cameras);

// Prints a line with all findings for each camera.
void print_findings(const training::RigFindings& findings, const std::vector<training::RigCamera>& cameras);

// The findings as bars, a row for each camera; orange where a correction is worth it.
media::Image draw_findings(const training::RigFindings& findings, const std::vector<training::RigCamera>& cameras);

}  // namespace neuvv::tools
