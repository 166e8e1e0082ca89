// Eye: one triangle that covers a view's image, drawn as one instance per view.
#version 460
#extension GL_ARB_shader_viewport_layer_array : require

layout(location = 0) flat out uint view;

void main() {
    gl_Position = vec4(vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 4.0 - 1.0, 0.0, 1.0);
    gl_Layer = gl_InstanceIndex;
    view = uint(gl_InstanceIndex);
}
