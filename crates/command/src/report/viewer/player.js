// Plays the motion of a run on its report.

import { POSE } from './renderer.js';
import { View } from './view.js';

/** Bytes out of base64. */
function unpacked(text) {
    return Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
}

/** Corners of all triangles, one after the other. */
function soup(mesh) {
    const [vertices, triangles] = [new Float32Array(unpacked(mesh.vertices)), new Uint32Array(unpacked(mesh.triangles))];
    const corners = new Float32Array(3 * triangles.length);
    triangles.forEach((v, i) => corners.set(vertices.subarray(3 * v, 3 * v + 3), 3 * i));
    return corners;
}

const rotated = ([x, y, z, w], [a, b, c]) => {
    const [u, v, t] = [y * c - z * b + w * a, z * a - x * c + w * b, x * b - y * a + w * c];
    return [a + 2 * (y * t - z * v), b + 2 * (z * u - x * t), c + 2 * (x * v - y * u)];
};

const turnedBy = ([x, y, z, w], [a, b, c, d]) => [
    w * a + x * d + y * c - z * b,
    w * b - x * c + y * d + z * a,
    w * c + x * b - y * a + z * d,
    w * d - x * a - y * b - z * c,
];

/** The poses of a film between its frames. */
class Film {
    constructor(film) {
        Object.assign(this, film);
        this.positions = new Float32Array(unpacked(film.positions));
        this.rotations = new Int16Array(unpacked(film.rotations));
        this.asleep = new Uint8Array(unpacked(film.asleep));
        this.poses = new Float32Array(POSE * film.shapes.length);
    }

    /** Position, rotation and sleep of a body, `share` of the way from a frame to the next. */
    body(body, frame, share) {
        const a = frame * this.bodies + body;
        const b = share > 0 ? a + this.bodies : a;
        const position = [0, 1, 2].map((i) => {
            const [from, to] = [this.positions[3 * a + i], this.positions[3 * b + i]];
            return from + (to - from) * share;
        });
        const [from, to] = [a, b].map((pose) => this.rotations.subarray(4 * pose, 4 * pose + 4));
        // Two quaternions are one rotation: the one on the same side.
        const side = from[0] * to[0] + from[1] * to[1] + from[2] * to[2] + from[3] * to[3] < 0 ? -1 : 1;
        const turn = [0, 1, 2, 3].map((i) => from[i] + (side * to[i] - from[i]) * share);
        const length = Math.hypot(...turn) || 1;
        return { position, turn: turn.map((x) => x / length), asleep: (this.asleep[a >> 3] >> (a & 7)) & 1 };
    }

    /** All poses at a time, counted in frames. */
    at(time) {
        const frame = Math.min(Math.floor(time), this.frames - 1);
        const share = frame + 1 < this.frames ? time - frame : 0;
        this.shapes.forEach(([, , body], i) => {
            const place = this.places[i];
            if (body < 0) {
                this.poses.set([...place, 0], POSE * i);
                return;
            }
            const { position, turn, asleep } = this.body(body, frame, share);
            const offset = rotated(turn, place);
            this.poses.set(position.map((x, k) => x + offset[k]), POSE * i);
            this.poses.set([...turnedBy(turn, place.slice(3)), asleep], POSE * i + 3);
        });
        return this.poses;
    }
}

class Player {
    constructor(root, film) {
        [this.film, this.time, this.playing] = [film, 0, false];
        const find = (name) => root.querySelector(name);
        [this.button, this.slider, this.shown, this.speed] = ['button', 'input', 'output', 'select'].map(find);
        this.view = new View(find('canvas'));
        this.view.setScene(film.meshes.map(soup), film.shapes.flatMap(([mesh, tone]) => [mesh, tone]), film.links.flat());
        this.slider.max = film.frames - 1;
        this.slider.addEventListener('input', () => {
            this.play(false);
            this.show(Number(this.slider.value), 0.05);
        });
        this.button.addEventListener('click', () => this.play(!this.playing));
        this.show(0, 0);
    }

    /** Shows a time, counted in frames; `seconds` since the last one that was shown. */
    show(time, seconds) {
        this.time = time;
        this.slider.value = time;
        this.shown.value = `${(time * this.film.interval).toFixed(2)} s`;
        this.view.setPoses(this.film.at(time), seconds);
    }

    play(playing) {
        this.playing = playing;
        this.button.textContent = playing ? 'Pause' : 'Play';
        if (!playing || this.running) return;
        this.running = true;
        const last = this.film.frames - 1;
        if (this.time >= last) this.time = 0;
        let before = performance.now();
        const frame = (now) => {
            this.running = this.playing;
            if (!this.playing) return;
            const passed = Math.min(0.1, Math.max(0, now - before) / 1000);
            before = now;
            const time = this.time + (passed * Number(this.speed.value)) / this.film.interval;
            this.show(Math.min(time, last), passed);
            if (time >= last) {
                this.play(false);
                this.running = false;
            } else requestAnimationFrame(frame);
        };
        requestAnimationFrame(frame);
    }
}

const root = document.querySelector('.player');
try {
    const film = new Film(JSON.parse(document.getElementById('film').textContent));
    // `player` is for the console, and for tests.
    globalThis.player = new Player(root, film);
    globalThis.player.play(!matchMedia('(prefers-reduced-motion: reduce)').matches);
} catch (error) {
    root.querySelector('figcaption').textContent = `The motion can't be shown: ${error.message}.`;
    console.error(error);
}
