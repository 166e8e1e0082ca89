// Groups of fields that the tabs of properties, paint and light consist of.
#pragma once

#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

// Displays a tooltip for the last field once the pointer rests on it.
void explain(const char* text);
// The title above a group of fields.
void headline(const char* text);

// The fields of the performer on a node, with its clip and its time map.
void performer_fields(Context& context, FieldGroup& group, PropertyFields::Time& time, uint32_t node);

// The fields of the whole stage. A document must be open.
void stage_fields(Context& context, FieldGroup& group);
// Those of them that concern light: ambient light, environment, shadows, falloff.
void stage_light_fields(Context& context, FieldGroup& group);

}  // namespace neuvv::viewer
