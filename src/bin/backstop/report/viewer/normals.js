// Normals of triangles that say nothing of them.

/** Cosine of the angle up to which neighbouring triangles count as one round surface. */
const CREASE = 0.8;

/** For each corner of a list of triangles, the number of its vertex; equal corners have one vertex. */
function weld(corners) {
    const bits = new Uint32Array(corners.buffer, corners.byteOffset, corners.length);
    const count = corners.length / 3;
    const size = 2 ** Math.ceil(Math.log2(2 * count + 1));
    const table = new Int32Array(size).fill(-1); // the first corner at a place
    const vertex = new Uint32Array(count);
    let vertices = 0;
    for (let i = 0; i < count; i++) {
        const [a, b, c] = [bits[3 * i], bits[3 * i + 1], bits[3 * i + 2]];
        let slot = Math.imul(Math.imul(a, 0x9e3779b1) ^ Math.imul(b, 0x85ebca6b) ^ c, 0xc2b2ae35);
        slot = (slot ^ (slot >>> 15)) & (size - 1);
        for (;;) {
            const other = table[slot];
            if (other < 0) {
                table[slot] = i;
                vertex[i] = vertices++;
                break;
            }
            if (bits[3 * other] === a && bits[3 * other + 1] === b && bits[3 * other + 2] === c) {
                vertex[i] = vertex[other];
                break;
            }
            slot = (slot + 1) & (size - 1);
        }
    }
    return { vertex, vertices };
}

/** Cross products of two sides of each triangle: along its normal, twice as long as its area. */
function areas(corners) {
    const out = new Float32Array(corners.length / 3);
    for (let t = 0; t < out.length; t += 3) {
        const [a, b, c] = [0, 3, 6].map((k) => corners.subarray(3 * t + k, 3 * t + k + 3));
        const [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        const [vx, vy, vz] = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
        out.set([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], t);
    }
    return out;
}

/** Corners and their normals, six numbers each: round where triangles meet at a small angle. */
export function withNormals(corners) {
    const { vertex, vertices } = weld(corners);
    const area = areas(corners);
    const length = (t) => Math.hypot(area[t], area[t + 1], area[t + 2]);
    // The triangles of each vertex, one after the other.
    const start = new Uint32Array(vertices + 1);
    vertex.forEach((v) => start[v + 1]++);
    for (let v = 0; v < vertices; v++) start[v + 1] += start[v];
    const next = start.slice();
    const around = new Uint32Array(vertex.length);
    vertex.forEach((v, i) => (around[next[v]++] = 3 * Math.floor(i / 3)));
    const out = new Float32Array(2 * corners.length);
    for (let i = 0; i < vertex.length; i++) {
        const own = 3 * Math.floor(i / 3);
        const ownLength = length(own) || 1;
        let [x, y, z] = [0, 0, 0];
        for (let k = start[vertex[i]]; k < start[vertex[i] + 1]; k++) {
            const t = around[k];
            const along = area[own] * area[t] + area[own + 1] * area[t + 1] + area[own + 2] * area[t + 2];
            if (t !== own && along < CREASE * ownLength * length(t)) continue;
            x += area[t];
            y += area[t + 1];
            z += area[t + 2];
        }
        const scale = 1 / (Math.hypot(x, y, z) || 1);
        out.set([corners[3 * i], corners[3 * i + 1], corners[3 * i + 2], x * scale, y * scale, z * scale], 6 * i);
    }
    return out;
}
