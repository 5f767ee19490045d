// Four vertices a splat, SPLATS_PER_INSTANCE splats an instance, far to near.
uniform usampler2D order;
uniform sampler2D placed, axes, colors;
uniform int visible;
uniform vec2 size;  // width height, pixels

out vec2 offset;  // from the centre, in standard deviations
flat out vec4 color;

void main() {
    int rank = gl_InstanceID * SPLATS_PER_INSTANCE + gl_VertexID / 4;
    offset = vec2(0.0);
    color = vec4(0.0);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside: nothing is drawn
    if (rank >= visible) return;
    int i = int(texelFetch(order, ivec2(rank % ROW, rank / ROW), 0).r);
    ivec2 at = ivec2(i % ROW, i / ROW);
    vec4 p = texelFetch(placed, at, 0), a = texelFetch(axes, at, 0);
    vec2 far = p.w * sqrt(a.xy * a.xy + a.zw * a.zw);
    if (p.w <= 0.0 || any(lessThan(p.xy + far, vec2(0.0))) || any(greaterThan(p.xy - far, size))) return;
    offset = p.w * vec2(float(gl_VertexID & 1) * 2.0 - 1.0, float((gl_VertexID >> 1) & 1) * 2.0 - 1.0);
    color = vec4(texelFetch(colors, at, 0).rgb, p.z);
    // rows of the target run downwards like those of an image: the picture is read without a flip
    gl_Position = vec4((p.xy + offset.x * a.xy + offset.y * a.zw) / size * 2.0 - 1.0, 0.0, 1.0);
}
