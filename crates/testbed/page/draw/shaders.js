// What runs on the graphics card.

/** Shared by all: how a picture fades into its background. */
const BACKGROUND = `
vec3 background(float height) {
    return mix(vec3(0.70, 0.75, 0.81), vec3(0.88, 0.91, 0.94), smoothstep(0.0, 0.9, height));
}
// Linear light to what a screen shows.
vec3 shown(vec3 c) {
    c = c / (1.0 + 0.18 * c);
    return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2));
}
`;

/** What is added to the distance from an edge that two triangles of a round surface share: it is not drawn. */
export const ROUND = 1e3;

const HEAD = '#version 300 es\nprecision highp float;\nprecision highp int;\n';

export const SHAPE_VERTEX = `${HEAD}
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 place;
layout(location = 3) in vec4 turn;
layout(location = 4) in float asleep;
layout(location = 5) in vec4 look; // colour, and its tone, with 16 more where it is selected
layout(location = 6) in vec3 edges;
uniform mat4 clip;
uniform vec3 eye;
uniform float pixel; // height of a pixel at a distance of 1
uniform float wide;  // half of the mesh where it is widest
out vec3 at;
out vec3 facing;
out vec3 edge;
flat out vec3 shade;
flat out vec3 style; // tone, selected, asleep

vec3 turned(vec3 v) {
    return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
}

void main() {
    // What moves is never smaller than a few pixels. Planes reach to where all fades.
    float selected = step(15.5, look.w);
    float tone = look.w - 16.0 * selected;
    float grow = tone > 7.5 ? 30.0 : tone < 5.5 ? max(1.0, 2.5 * pixel * distance(eye, place) / wide) : 1.0;
    at = place + turned(corner * grow);
    facing = turned(normal);
    edge = edges;
    shade = look.rgb;
    style = vec3(tone, selected, asleep);
    gl_Position = clip * vec4(at, 1.0);
}
`;

export const SHAPE_FRAGMENT = `${HEAD}
precision highp sampler2DShadow;
in vec3 at;
in vec3 facing;
in vec3 edge;
flat in vec3 shade;
flat in vec3 style;
uniform float dims;    // 1 if what is asleep is dim
uniform float wire;    // 1 if only edges of triangles are drawn
uniform vec3 eye;
uniform vec3 target;
uniform float large;   // 1 if the mesh is as large as what is framed
uniform float glass;   // 1 while walls are drawn
uniform vec3 sun;
uniform float radius;  // of what the camera frames
uniform float height;  // of the picture
uniform mat4 sunlight; // world to shadow map
uniform float texel;   // of the shadow map, in the world
uniform sampler2DShadow shadows;
out vec4 colour;
#define ROUND ${ROUND.toFixed(1)}
${BACKGROUND}

float lit(vec3 n) {
    vec3 p = (sunlight * vec4(at + n * texel * 2.0, 1.0)).xyz * 0.5 + 0.5;
    if (any(lessThan(p, vec3(0.0))) || any(greaterThan(p, vec3(1.0)))) return 1.0;
    float step = 1.0 / float(textureSize(shadows, 0).x);
    float sum = 0.0;
    for (int i = -1; i <= 1; i++) {
        for (int k = -1; k <= 1; k++) sum += texture(shadows, vec3(p.xy + 1.3 * step * vec2(i, k), p.z - 0.0006));
    }
    return sum / 9.0;
}

// How much of a pixel lines of a width in pixels cover, at every whole number of x.
float lines(vec2 x, float width) {
    vec2 change = fwidth(x);
    vec2 away = abs(fract(x - 0.5) - 0.5) / max(change, vec2(1e-6));
    vec2 cover = clamp(width - away, 0.0, 1.0) * clamp(1.2 - 4.0 * change, 0.0, 1.0);
    return max(cover.x, cover.y);
}

void main() {
    int tone = int(style.x + 0.5);
    vec3 n = normalize(facing);
    vec3 towards = normalize(eye - at);
    if (!gl_FrontFacing) n = -n;
    // Walls would hide what is between them: they are drawn by themselves, like glass.
    bool wall = tone == 6 && large > 0.5 && abs(n.y) < 0.7;
    if (wall != (glass > 0.5)) discard;
    vec3 across = edge - ROUND * step(0.5 * ROUND, edge);
    if (wire > 0.5) {
        vec3 on = clamp(1.1 - across / max(fwidth(across), vec3(1e-6)), 0.0, 1.0);
        float cover = max(on.x, max(on.y, on.z));
        if (cover < 0.35) discard;
        colour = vec4(shade * (dims > 0.5 && style.z > 0.5 ? 0.45 : 0.72), 1.0);
        return;
    }
    vec3 base = pow(shade, vec3(2.2));
    bool asleep = dims > 0.5 && style.z > 0.5;
    if (asleep && tone < 6) base = mix(base, vec3(dot(base, vec3(0.3, 0.5, 0.2))), 0.65) * 0.62;
    if (tone >= 6 && abs(n.y) > 0.5) {
        float line = max(0.16 * lines(at.xz, 0.9), 0.3 * lines(at.xz * 0.1, 1.2));
        base *= 1.0 - line;
    }
    if (tone == 7) {
        // The triangles of a terrain, where they are not too small.
        vec3 fine = fwidth(across);
        vec3 on = clamp(1.1 - across / max(fine, vec3(1e-6)), 0.0, 1.0) * clamp(1.2 - 6.0 * fine, 0.0, 1.0);
        base *= 1.0 - 0.3 * max(on.x, max(on.y, on.z));
    }
    vec3 change = fwidth(edge);
    vec3 near = clamp(1.4 - edge / max(change, vec3(1e-6)), 0.0, 1.0) * clamp(1.5 - 5.0 * change, 0.0, 1.0);
    base *= 1.0 - 0.4 * max(near.x, max(near.y, near.z));
    float direct = max(dot(n, sun), 0.0);
    if (direct > 0.0) direct *= lit(n);
    vec3 sky = mix(vec3(0.30, 0.28, 0.27), vec3(0.52, 0.57, 0.66), 0.5 + 0.5 * n.y);
    vec3 light = base * (sky + direct * vec3(1.02, 0.97, 0.88));
    if (tone < 6) {
        float gloss = pow(max(dot(n, normalize(sun + towards)), 0.0), 40.0) * step(0.001, direct);
        float rim = pow(1.0 - max(dot(n, towards), 0.0), 4.0);
        light += style.y * vec3(0.30, 0.24, 0.05) * (0.25 + rim);
        light += (0.16 * gloss + 0.10 * rim) * (asleep ? 0.3 : 1.0);
    }
    float away = distance(at.xz, target.xz) / radius;
    float fog = tone < 6 ? 0.0 : smoothstep(2.2, 6.5, away);
    vec3 seen = mix(shown(light), background(gl_FragCoord.y / height), fog);
    float cover = wall ? 0.22 * (1.0 - fog) : 1.0;
    colour = vec4(seen * cover, cover);
}
`;

export const SHADOW_FRAGMENT = `${HEAD}
void main() {}
`;

export const SKY_VERTEX = `${HEAD}
void main() {
    vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(p, 0.9999, 1.0);
}
`;

export const SKY_FRAGMENT = `${HEAD}
uniform float height;
out vec4 colour;
${BACKGROUND}
void main() {
    colour = vec4(background(gl_FragCoord.y / height), 1.0);
}
`;

/** Lines as strips of a width in pixels, an instance each. */
export const LINE_VERTEX = `${HEAD}
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 fromShade;
layout(location = 2) in vec3 to;
layout(location = 3) in vec3 toShade;
uniform mat4 clip;
uniform vec2 size;  // of the picture [pixels]
uniform float wide; // [pixels]
out vec3 shade;
out float across;   // from the middle of the line [pixels]
#define NEAR 1e-3
void main() {
    vec4 p = clip * vec4(from, 1.0);
    vec4 q = clip * vec4(to, 1.0);
    // Ends behind the eye are moved before it.
    if (p.w < NEAR && q.w > NEAR) p = mix(p, q, (NEAR - p.w) / (q.w - p.w));
    if (q.w < NEAR && p.w > NEAR) q = mix(q, p, (NEAR - q.w) / (p.w - q.w));
    vec2 along = (q.xy / q.w - p.xy / p.w) * size;
    float length2 = dot(along, along);
    along = length2 > 1e-6 ? along * inversesqrt(length2) : vec2(1.0, 0.0);
    bool last = gl_VertexID > 1;
    float half_wide = 0.5 * wide + 1.0;
    across = (gl_VertexID & 1) == 1 ? half_wide : -half_wide;
    shade = last ? toShade : fromShade;
    vec4 end = last ? q : p;
    vec2 out_of = vec2(-along.y, along.x) * across + along * (last ? 0.5 : -0.5);
    // A little nearer than the surface that it lies on.
    gl_Position = vec4(end.xy + 2.0 * out_of / size * end.w, end.z - 2e-4 * end.w, end.w);
}
`;

export const LINE_FRAGMENT = `${HEAD}
in vec3 shade;
in float across;
uniform float wide;
uniform float cover;
out vec4 colour;
void main() {
    float c = cover * clamp(0.5 * wide + 0.5 - abs(across), 0.0, 1.0);
    colour = vec4(shade * c, c);
}
`;

/** Points, with a kind. */
export const POINT_VERTEX = `${HEAD}
layout(location = 0) in vec4 mark;
uniform mat4 clip;
uniform float wide; // [pixels]
flat out int kind;
out float radius;
void main() {
    kind = int(mark.w + 0.5);
    gl_Position = clip * vec4(mark.xyz, 1.0);
    gl_PointSize = wide * (kind == 2 ? 1.5 : 1.0);
    radius = 0.5 * gl_PointSize;
}
`;

export const POINT_FRAGMENT = `${HEAD}
flat in int kind;
in float radius;
uniform vec3 marks[4];
out vec4 colour;
void main() {
    // A disc with a white rim.
    float away = 2.0 * length(gl_PointCoord - 0.5) * radius;
    float cover = clamp(radius - away, 0.0, 1.0);
    float inner = clamp(0.74 * radius - away + 0.5, 0.0, 1.0);
    colour = vec4(mix(vec3(1.0), marks[kind], inner) * cover, cover);
}
`;
