// One fragment is one splat: activation and EWA projection (docs/conventions.md).
uniform sampler2D positions, rotations, log_scales, logits;
uniform mat4 world_to_camera;
uniform vec4 lens;  // fx fy cx cy, pixels
uniform vec2 size;  // width height, pixels

layout(location = 0) out vec4 placed;  // centre x y in pixels, opacity, reach in standard deviations
layout(location = 1) out vec4 axes;    // the two semi-axes of one standard deviation, pixels

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    placed = vec4(0.0);
    axes = vec4(0.0);

    vec3 p = (world_to_camera * vec4(texelFetch(positions, at, 0).xyz, 1.0)).xyz;
    float opacity = 1.0 / (1.0 + exp(-texelFetch(logits, at, 0).x));
    // the depth order leaves such splats out too: this only spares the arithmetic
    if (!(p.z >= NEAR) || !(opacity >= ALPHA_MIN)) return;

    vec4 q = texelFetch(rotations, at, 0);
    float len = dot(q, q);
    q = len < 1e-24 ? vec4(1.0, 0.0, 0.0, 0.0) : q * inversesqrt(len);
    float w = q.x, x = q.y, y = q.z, z = q.w;
    mat3 turn = mat3(
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
        2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
        2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
    vec3 s = exp(texelFetch(log_scales, at, 0).xyz);
    mat3 m = mat3(world_to_camera) * mat3(turn[0] * s.x, turn[1] * s.y, turn[2] * s.z);

    vec2 slope = clamp(p.xy / p.z, (-VIEW_MARGIN * size - lens.zw) / lens.xy,
                       ((1.0 + VIEW_MARGIN) * size - lens.zw) / lens.xy);
    vec3 row0 = vec3(m[0].x, m[1].x, m[2].x), row1 = vec3(m[0].y, m[1].y, m[2].y), row2 = vec3(m[0].z, m[1].z, m[2].z);
    vec3 u = lens.x / p.z * (row0 - slope.x * row2);
    vec3 v = lens.y / p.z * (row1 - slope.y * row2);
    float a = dot(u, u) + DILATION, b = dot(u, v), c = dot(v, v) + DILATION;
    // a c - b^2 without its cancellation: the minors of the projected axes, and what the dilation adds
    vec3 minors = cross(u, v);
    float det = dot(minors, minors) + DILATION * (a + c - DILATION);

    float half_gap = 0.5 * (a - c);
    float spread = length(vec2(half_gap, b));
    float major = 0.5 * (a + c) + spread;
    if (!(det > 0.0) || !(major < 1e18)) return;
    vec2 along = vec2(1.0, 0.0);
    if (spread > 1e-7 * major)
        along = normalize(half_gap >= 0.0 ? vec2(spread + half_gap, b) : vec2(b, spread - half_gap));
    float minor = det / major;  // and not mean - spread, which cancels

    float reach = sqrt(max(2.0 * log(opacity / ALPHA_MIN), 0.0));
    placed = vec4(lens.xy * p.xy / p.z + lens.zw, opacity, reach);
    axes = vec4(along * sqrt(major), vec2(-along.y, along.x) * sqrt(minor));
}
