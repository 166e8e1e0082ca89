// Eye shapes: the colour between vertices.
#version 460

layout(location = 0) in vec4 light;
layout(location = 0) out vec4 shown;

void main() {
    shown = light;
}
