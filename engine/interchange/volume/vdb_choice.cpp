#include "interchange/volume/vdb_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/text.h"

namespace neuvv::interchange {

namespace {

constexpr const char* kDensity = "density";
constexpr const char* kColours[] = {"cd", "color", "colour", "albedo"};
constexpr size_t kMostListed = 20;

bool is_level_set(const VdbGrid& grid) {
    return grid.grid_class == "level set";
}

// "heat (float, 1200 voxels)".
std::string text_of(const VdbGrid& grid) {
    if (!grid.unread.empty()) return fmt::format("{} ({})", grid.name, grid.unread);
    return fmt::format("{} ({}{}, {} voxels)", grid.name, grid.type, is_level_set(grid) ? ", level set" : "",
                       grid.voxel_count());
}

std::string text_of(std::span<const VdbGrid> grids, const std::vector<size_t>& listed) {
    std::string text;
    for (size_t i = 0; i < std::min(listed.size(), kMostListed); ++i)
        text += (i > 0 ? ", " : "") + text_of(grids[listed[i]]);
    if (listed.size() > kMostListed) text += fmt::format(" and {} more", listed.size() - kMostListed);
    return text;
}

// Those with values of so many channels, but no level sets.
std::vector<size_t> usable(std::span<const VdbGrid> grids, uint32_t channels) {
    std::vector<size_t> found;
    for (size_t i = 0; i < grids.size(); ++i)
        if (grids[i].unread.empty() && grids[i].channels == channels && !is_level_set(grids[i])) found.push_back(i);
    return found;
}

std::vector<size_t> named(std::span<const VdbGrid> grids, std::vector<size_t> among, const std::string& name) {
    std::erase_if(among, [&](size_t i) { return lower_case(grids[i].name) != name; });
    return among;
}

std::vector<size_t> all(std::span<const VdbGrid> grids) {
    std::vector<size_t> indices;
    for (size_t i = 0; i < grids.size(); ++i) indices.push_back(i);
    return indices;
}

// The first of several grids of a name, with a note where there are more.
size_t first_of(std::span<const VdbGrid> grids, const std::vector<size_t>& found, std::vector<std::string>& notes) {
    if (found.size() > 1)
        notes.push_back(fmt::format("has {} grids named {}, of which the first is shown: {}", found.size(),
                                    grids[found[0]].name, text_of(grids[found[0]])));
    return found[0];
}

size_t density_of(std::span<const VdbGrid> grids, const std::string& file, std::vector<std::string>& notes) {
    const std::vector<size_t> numbers = usable(grids, 1), densities = named(grids, numbers, kDensity);
    if (!densities.empty()) return first_of(grids, densities, notes);
    // A density that cannot be shown is not replaced by what happens to be there.
    if (const auto others = named(grids, all(grids), kDensity); !others.empty())
        throw InputError(file, kDensity, fmt::format("is no fog volume of numbers: {}", text_of(grids, others)),
                         "write it as a fog volume of floats");
    if (numbers.size() != 1)
        throw InputError(file, "",
                         fmt::format("has no fog volume named density; it has {}",
                                     grids.empty() ? "no grids" : text_of(grids, all(grids))),
                         "name the one that is to be read so");
    notes.push_back(
        fmt::format("has no grid named density; its only one of numbers is shown: {}", text_of(grids[numbers[0]])));
    return numbers[0];
}

}  // namespace

VdbChoice choose_grids(std::span<const VdbGrid> grids, const std::string& file) {
    VdbChoice choice;
    choice.density = density_of(grids, file, choice.notes);
    for (const char* name : kColours) {
        const std::vector<size_t> found = named(grids, usable(grids, 3), name);
        if (found.empty()) continue;
        choice.colour = first_of(grids, found, choice.notes);
        break;
    }
    const VdbGrid& density = grids[choice.density];
    if (density.type == "bool" || density.type == "mask")
        choice.notes.push_back(
            fmt::format("{} is of the type {}: each of its voxels is a density of 1 per unit of length", density.name,
                        density.type));
    std::vector<size_t> rest = all(grids);
    std::erase_if(rest, [&](size_t i) { return i == choice.density || choice.colour == i; });
    if (!rest.empty()) choice.notes.push_back("does not show " + text_of(grids, rest));
    return choice;
}

}  // namespace neuvv::interchange
