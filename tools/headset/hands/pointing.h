// What the pointer rays of hands hit: the panel, else a performer, or the marker of a light or camera, else the set or
// the floor.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "editor/draw/set_surface.h"
#include "tools/headset/state/hand.h"
#include "tools/headset/state/headset_state.h"
#include "tools/headset/state/panel_placement.h"

namespace neuvv::headset {

// The performer whose surface a ray meets first.
struct SurfaceHit {
    uint32_t performer = 0;  // index into Stage::performers
    double distance_m = 0;
    std::optional<glm::vec3> colour;  // as PointerHit::colour
};
// Returns a result for each ray (world), or that of the same hand's ray of the frame before; nothing where a ray meets
// no surface. Only a device can know, so it is given from outside.
using FindSurfaces = std::function<std::vector<std::optional<SurfaceHit>>(std::span<const Ray>)>;

// Sets Hand::hit and Hand::pointed_node of both hands. A ray takes the performer whose surface it meets; where it meets
// none, or where `find_surfaces` is empty, the performer whose box it enters first, so that one may also point between
// a performer's legs. While the tool kLights is selected, boxes do not count, but markers do (markers.h), also behind
// the set. A hand whose ray comes to another performer or marker than before is vibrated shortly. With `set`, rays meet
// the set, too, whose triangles hide performers behind them; without it, they go through it.
void point(Hands& hands, const HeadsetState& state, const std::optional<PanelPlacement>& panel,
           const FindSurfaces& find_surfaces, const editor::SetSurface* set = nullptr);

// The performer that a hand points at, an index into Stage::performers; the right hand goes first.
std::optional<uint32_t> pointed_performer(const Hands& hands);

}  // namespace neuvv::headset
