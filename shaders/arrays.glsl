// Arrays that may have more than 65,536 elements, which is all that some devices bind as a texel buffer. The build
// compiles shaders that declare such arrays twice: as they are, for texel buffers, and with NEUVV_STORAGE_BUFFERS
// (engine/gpu/buffer_profile.h). With NEUVV_TEXTURES, arrays that are only read are textures. Arrays that are always
// short are declared as texel buffers without these macros.
//   READ_ARRAY(type, binding, name)    an array that the shader only reads
//   WRITE_ARRAY(type, binding, name)   one that it only writes
//   UPDATE_ARRAY(type, binding, name)  one that it reads and writes
//   FETCH(name, i)         element i of an array that is only read, as texelFetch returns it
//   LOAD(name, i)          element i of an array that is also written, as imageLoad returns it
//   STORE(name, i, value)  writes it as imageStore does, from a vec4 or uvec4
//   ELEMENTS(name)         the length of an array that is written
// i is an int. The types are float, vec2, vec4, uint, uvec2 and uvec4. Arrays that are only read may also be of half4,
// four fp16 numbers, or of any4, where the buffer decides between fp32 and fp16 (weights.glsl reads it).
#ifndef NEUVV_ARRAYS_GLSL
#define NEUVV_ARRAYS_GLSL

#ifdef NEUVV_STORAGE_BUFFERS
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

struct half4 {
    uvec2 words;
};
#define any4 half4  // with fp32, two of these are an element

vec4 element(float value) { return vec4(value, 0.0, 0.0, 1.0); }
vec4 element(vec2 value) { return vec4(value, 0.0, 1.0); }
vec4 element(vec4 value) { return value; }
uvec4 element(uint value) { return uvec4(value, 0u, 0u, 1u); }
uvec4 element(uvec2 value) { return uvec4(value, 0u, 1u); }
uvec4 element(uvec4 value) { return value; }
vec4 element(half4 value) { return vec4(unpackHalf2x16(value.words.x), unpackHalf2x16(value.words.y)); }

void set_element(out float to, vec4 value) { to = value.x; }
void set_element(out vec2 to, vec4 value) { to = value.xy; }
void set_element(out vec4 to, vec4 value) { to = value; }
void set_element(out uint to, uvec4 value) { to = value.x; }
void set_element(out uvec2 to, uvec4 value) { to = value.xy; }
void set_element(out uvec4 to, uvec4 value) { to = value; }

#define READ_ARRAY(type, number, name) layout(binding = number, std430) readonly buffer name##_buffer { type name[]; }
#define WRITE_ARRAY(type, number, name) layout(binding = number, std430) buffer name##_buffer { type name[]; }
#define UPDATE_ARRAY(type, number, name) layout(binding = number, std430) buffer name##_buffer { type name[]; }
#define FETCH(name, i) element(name[i])
#define LOAD(name, i) element(name[i])
#define STORE(name, i, value) set_element(name[i], value)
#define ELEMENTS(name) name.length()

#elif defined(NEUVV_TEXTURES)

// Two-dimensional textures, for OpenGL ES 3.0, which has no other long arrays (tools/web/).
const int kTextureWidthLog2 = 12;
#define TEXTURE_uint usampler2D
#define TEXTURE_uvec2 usampler2D
#define TEXTURE_uvec4 usampler2D
#define READ_ARRAY(type, number, name) layout(binding = number) uniform TEXTURE_##type name
#define FETCH(name, i) texelFetch(name, ivec2((i) & ((1 << kTextureWidthLog2) - 1), (i) >> kTextureWidthLog2), 0)

#else

#define TEXELS_float textureBuffer
#define TEXELS_vec2 textureBuffer
#define TEXELS_vec4 textureBuffer
#define TEXELS_half4 textureBuffer
#define TEXELS_any4 textureBuffer
#define TEXELS_uint utextureBuffer
#define TEXELS_uvec2 utextureBuffer
#define TEXELS_uvec4 utextureBuffer
#define IMAGE_float imageBuffer
#define IMAGE_vec2 imageBuffer
#define IMAGE_vec4 imageBuffer
#define IMAGE_uint uimageBuffer
#define IMAGE_uvec2 uimageBuffer
#define IMAGE_uvec4 uimageBuffer
#define FORMAT_float r32f
#define FORMAT_vec2 rg32f
#define FORMAT_vec4 rgba32f
#define FORMAT_uint r32ui
#define FORMAT_uvec2 rg32ui
#define FORMAT_uvec4 rgba32ui

#define READ_ARRAY(type, number, name) layout(binding = number) uniform TEXELS_##type name
#define WRITE_ARRAY(type, number, name) layout(binding = number, FORMAT_##type) writeonly uniform IMAGE_##type name
#define UPDATE_ARRAY(type, number, name) layout(binding = number, FORMAT_##type) uniform IMAGE_##type name
#define FETCH(name, i) texelFetch(name, i)
#define LOAD(name, i) imageLoad(name, i)
#define STORE(name, i, value) imageStore(name, i, value)
#define ELEMENTS(name) imageSize(name)

#endif
#endif
