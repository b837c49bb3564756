// Normals and edges of triangles that say nothing of them.

import { ROUND } from './shaders.js';

/** Cosine of the angle up to which neighbouring triangles count as one round surface. */
const CREASE = 0.8;

/** For each corner of a list of triangles, the number of its vertex; equal corners have one vertex. */
function weld(soup) {
    const bits = new Uint32Array(soup.buffer, soup.byteOffset, soup.length);
    const count = soup.length / 3;
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
function areas(soup) {
    const out = new Float32Array(soup.length / 3);
    for (let t = 0; t < out.length; t += 3) {
        const [a, b, c] = [0, 3, 6].map((k) => soup.subarray(3 * t + k, 3 * t + k + 3));
        const [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        const [vx, vy, vz] = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
        out.set([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], t);
    }
    return out;
}

/** The triangles at each vertex, as indices of their first numbers: those of vertex v from start[v] on. */
function neighbours({ vertex, vertices }) {
    const start = new Uint32Array(vertices + 1);
    vertex.forEach((v) => start[v + 1]++);
    for (let v = 0; v < vertices; v++) start[v + 1] += start[v];
    const next = start.slice();
    const around = new Uint32Array(vertex.length);
    vertex.forEach((v, i) => (around[next[v]++] = i - (i % 3)));
    return { start, around };
}

/** Numbers of a corner: position, normal, and for each edge of the triangle how far away it is, 0 to 1. */
export const CORNER = 9;

/**
 * Corners with what the renderer needs of them. Where triangles meet at a small angle they count as round, and
 * their edge as none: it is infinitely far away.
 */
export function cornersOf(soup) {
    const welded = weld(soup);
    const { vertex } = welded;
    const { start, around } = neighbours(welded);
    const area = areas(soup);
    const length = (t) => Math.hypot(area[t], area[t + 1], area[t + 2]);
    const along = (s, t) => area[s] * area[t] + area[s + 1] * area[t + 1] + area[s + 2] * area[t + 2];
    const isRound = (s, t) => s === t || along(s, t) >= CREASE * (length(s) || 1) * length(t);
    const has = (t, v) => vertex[t] === v || vertex[t + 1] === v || vertex[t + 2] === v;
    // Whether some triangle goes on beyond an edge as if there were none.
    const goesOn = (t, v, w) => {
        for (let k = start[v]; k < start[v + 1]; k++) {
            if (around[k] !== t && has(around[k], w) && isRound(t, around[k])) return true;
        }
        return false;
    };
    const out = new Float32Array(CORNER * vertex.length);
    for (let i = 0; i < vertex.length; i++) {
        const own = i - (i % 3);
        let [x, y, z] = [0, 0, 0];
        for (let k = start[vertex[i]]; k < start[vertex[i] + 1]; k++) {
            const t = around[k];
            if (!isRound(own, t)) continue;
            x += area[t];
            y += area[t + 1];
            z += area[t + 2];
        }
        const scale = 1 / (Math.hypot(x, y, z) || 1);
        out.set([soup[3 * i], soup[3 * i + 1], soup[3 * i + 2], x * scale, y * scale, z * scale], CORNER * i);
    }
    for (let t = 0; t < vertex.length; t += 3) {
        for (let k = 0; k < 3; k++) {
            // The edge across from corner k.
            const far = goesOn(t, vertex[t + ((k + 1) % 3)], vertex[t + ((k + 2) % 3)]) ? ROUND : 0;
            for (let c = 0; c < 3; c++) out[CORNER * (t + c) + 6 + k] = far + (c === k ? 1 : 0);
        }
    }
    return out;
}
