#include "web/time_map.h"

#include <fmt/format.h>

#include <memory>
#include <new>
#include <string>

#include "base/error.h"
#include "base/text.h"
#include "stage/performer_settings.h"
#include "stage/time_map.h"

struct NeuvvTimeMap {
    neuvv::stage::Timeline timeline;
    std::string error;
};

namespace {

std::unique_ptr<NeuvvTimeMap> time_map_of(const std::string& text, uint32_t frames, double fps) {
    const char *const file = neuvv::stage::kPerformerExtension, *const place = "time";
    auto map = std::make_unique<NeuvvTimeMap>();
    try {
        const std::vector<std::string> operators = neuvv::split(text, ',');
        for (size_t i = 0; i < operators.size(); ++i)  // so that an error says which it is
            neuvv::stage::parse_time_map(operators[i], file, fmt::format("{}/{}", place, i));
        map->timeline =
            neuvv::stage::timeline_of(neuvv::stage::parse_time_map(text, file, place), frames, fps, file, place);
    } catch (const neuvv::InputError& error) {
        map->error = error.what();
    }
    return map;
}

}  // namespace

NeuvvTimeMap* neuvv_time_map_new(const char* text, uint32_t frames, double fps) {
    try {
        return time_map_of(text, frames, fps).release();
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

void neuvv_time_map_free(NeuvvTimeMap* map) {
    const std::unique_ptr<NeuvvTimeMap> owner(map);
}

const char* neuvv_time_map_error(const NeuvvTimeMap* map) {
    return map->error.empty() ? nullptr : map->error.c_str();
}

double neuvv_time_map_frame(const NeuvvTimeMap* map, double stage_s) {
    return neuvv::stage::frame_at(map->timeline, stage_s);
}

double neuvv_time_map_position(const NeuvvTimeMap* map, double stage_s) {
    return neuvv::stage::clip_position(map->timeline, stage_s);
}

double neuvv_time_map_length(const NeuvvTimeMap* map) {
    return neuvv::stage::length_s(map->timeline);
}
