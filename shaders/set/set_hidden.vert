// Hidden parts of the set's image, which a headset's lenses do not show: drawn nearer than everything else.
#version 460

layout(location = 0) in vec2 corner;  // 0 to 1 from the upper left corner of the image

void main() {
    gl_Position = vec4(2.0 * corner - 1.0, 1.0, 1.0);
}
