// Hidden parts of the set's image: writes no light and a distance of 0, so that rays end where they begin.
#version 460

layout(location = 0) out vec4 light;
layout(location = 1) out float metres;

void main() {
    light = vec4(0.0);
    metres = 0.0;
}
