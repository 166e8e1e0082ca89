// Eye text: the vertices' colour where the font's image covers the pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/eye.h"

layout(binding = kTextFont) uniform sampler2D font;
layout(location = 0) in vec4 light;
layout(location = 1) in vec2 font_uv;
layout(location = 0) out vec4 colour;

void main() {
    colour = light * texture(font, font_uv).r;
}
