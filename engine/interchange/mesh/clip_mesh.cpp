#include "interchange/mesh/clip_mesh.h"

#include <utility>

#include "interchange/mesh/bake.h"
#include "interchange/mesh/simplify.h"
#include "interchange/mesh/surface_net.h"

namespace neuvv::interchange {

std::optional<ColouredMesh> clip_mesh(slice::Slice volume, const MeshSettings& settings,
                                      const std::function<void(std::string_view what)>& working) {
    const LeafGrid grid(std::move(volume));
    TriangleMesh surface = surface_of(solid_of(grid, settings.opacity, [&] { working("finding the surface"); }));
    surface = without_small_parts(surface, settings.smallest_part);
    if (settings.most_triangles > 0)
        surface = simplified(surface, settings.most_triangles, [&] { working("simplifying the mesh"); });
    ColouredMesh mesh;
    if (settings.texture_px == 0 || surface.triangles.empty()) {
        mesh.colours = vertex_colours(grid, surface);
        mesh.mesh = {surface.positions, normals_of(surface), {}, surface.triangles};
        return mesh;
    }
    const auto atlas = [&] { working("laying out the texture"); };
    std::optional<MappedMesh> mapped_surface = mapped(surface, settings.texture_px, atlas);
    if (!mapped_surface) return std::nullopt;
    mesh.mesh = std::move(*mapped_surface);
    mesh.texture = baked_texture(grid, mesh.mesh, settings.texture_px, [&] { working("baking the texture"); });
    return mesh;
}

}  // namespace neuvv::interchange
