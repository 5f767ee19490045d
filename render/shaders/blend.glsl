// Premultiplied light of one splat at one pixel.
in vec2 offset;
flat in vec4 color;
out vec4 light;

void main() {
    float alpha = min(color.a * exp(-0.5 * dot(offset, offset)), ALPHA_MAX);
    if (alpha < ALPHA_MIN) discard;
    light = vec4(color.rgb * alpha, alpha);
}
