// Hidden parts of the set's image, which no lens shows: nearer than all else.
#version 460

layout(location = 0) in vec2 corner;  // shares of the image from the upper left

void main() {
    gl_Position = vec4(2.0 * corner - 1.0, 1.0, 1.0);
}
