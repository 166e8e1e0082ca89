// Groups of fields of the properties and light tabs.
#pragma once

#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

// Explains the last field while the pointer rests on it.
void explain(const char* text);
// A line above a group of fields.
void headline(const char* text);

// Of the performer on a node, with its clip and its time.
void performer_fields(Context& context, FieldGroup& group, PropertyFields::Time& time, uint32_t node);

// Of the stage as a whole; the document is open.
void stage_fields(Context& context, FieldGroup& group);
// Those of them that light it: ambient light, environment, shadows, falloff.
void stage_light_fields(Context& context, FieldGroup& group);

}  // namespace neuvv::viewer
