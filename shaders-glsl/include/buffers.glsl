// Arrays in device memory, reached by address. `Read...` and `Write...` tell the engine which barriers a kernel needs;
// `Maybe...` may be left out, which `present` tells. Addresses are multiples of 16 bytes, so the x4 forms always serve.
#ifndef BUFFERS_GLSL
#define BUFFERS_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

#define BUFFER(NAME, TYPE, BYTES, ACCESS)                                        \
    layout(buffer_reference, std430, buffer_reference_align = BYTES) ACCESS buffer NAME { \
        TYPE at[];                                                               \
    }

BUFFER(ReadU32, uint, 4, readonly);
BUFFER(WriteU32, uint, 4, writeonly);
BUFFER(U32, uint, 4, );
BUFFER(MaybeReadU32, uint, 4, readonly);
BUFFER(MaybeWriteU32, uint, 4, writeonly);

BUFFER(ReadU64, uint64_t, 8, readonly);
BUFFER(WriteU64, uint64_t, 8, writeonly);
BUFFER(U64, uint64_t, 8, );

BUFFER(ReadU32x4, uvec4, 16, readonly);
BUFFER(WriteU32x4, uvec4, 16, writeonly);

#define present(REFERENCE) (any(notEqual(uvec2(REFERENCE), uvec2(0u))))

#endif
