// Lines and points over the shapes: contacts, joints, bounds.

import { attribute, program } from './gl.js';
import { LINE_FRAGMENT, LINE_VERTEX, POINT_FRAGMENT, POINT_VERTEX } from './shaders.js';

/** Colours of points: of contact, real, potential and ghost; centres of mass. */
export const MARKS = ['#c3121f', '#1668d8', '#d613b5', '#14181d'];
/** The colour of lines between joined shapes. */
const LINK = [0.19, 0.21, 0.24];
/** Numbers of an end of a line: position [m], tone. */
const END = 4;

const channels = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

/** A colour of 0 to 255 as the light ground lets it be seen: what is bright gets darker, white black. */
export function legible(tone) {
    const [r, g, b] = tone.map((x) => x / 255);
    const bright = 0.3 * r + 0.59 * g + 0.11 * b;
    if (Math.min(r, g, b) > 0.8) return LINK;
    const scale = bright > 0.5 ? 0.5 / bright + 0.12 : 1;
    return [r, g, b].map((x) => x * scale);
}

export class Marks {
    constructor(gl) {
        this.gl = gl;
        this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
        this.point = program(gl, POINT_VERTEX, POINT_FRAGMENT);
        [this.lines, this.links, this.points] = [0, 1, 2].map(() => this.buffer());
        for (const { array, data } of [this.lines, this.links]) {
            gl.bindVertexArray(array);
            gl.bindBuffer(gl.ARRAY_BUFFER, data);
            [0, 12, 24, 36].forEach((offset, i) => attribute(gl, i, 3, 48, offset, 1));
        }
        gl.bindVertexArray(this.points.array);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.points.data);
        attribute(gl, 0, 4, 16, 0, 0);
    }

    buffer() {
        return { array: this.gl.createVertexArray(), data: this.gl.createBuffer(), count: 0 };
    }

    fill(buffer, numbers, count) {
        const { gl } = this;
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer.data);
        gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STREAM_DRAW);
        buffer.count = count;
    }

    /** Ends of lines: position, and an index of `tones`, colours of 0 to 255; two ends a line. */
    setLines(ends, tones) {
        const shades = tones.map(legible);
        this.fillLines(this.lines, ends.length / END, (i) => ends.subarray(END * i, END * i + 3), (i) => shades[ends[END * i + 3]]);
    }

    /** Lines between pairs of places. */
    setLinks(places) {
        this.fillLines(this.links, places.length, (i) => places[i], () => LINK);
    }

    /** `place(i)` and `shade(i)` of each end. */
    fillLines(buffer, ends, place, shade) {
        const numbers = new Float32Array(6 * ends);
        for (let i = 0; i < ends; i++) {
            numbers.set(place(i), 6 * i);
            numbers.set(shade(i), 6 * i + 3);
        }
        this.fill(buffer, numbers, ends / 2);
    }

    /** Points: position and kind, an index of `MARKS`. */
    setPoints(points) {
        this.fill(this.points, points, Math.floor(points.length / 4));
    }

    /** `view` is the camera's; `size` that of the picture in pixels, `ratio` of them make one of the page. */
    draw(view, size, ratio) {
        const { gl } = this;
        const lines = (buffer, uniforms) => {
            if (buffer.count === 0) return;
            this.line.use({ clip: view.clip, size, ...uniforms });
            gl.bindVertexArray(buffer.array);
            gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, buffer.count);
        };
        gl.enable(gl.BLEND);
        gl.depthMask(false);
        lines(this.links, { wide: 1.6 * ratio, cover: 0.9 });
        // What is hidden shows through faintly: contacts are between bodies.
        gl.depthFunc(gl.GREATER);
        lines(this.lines, { wide: 1.4 * ratio, cover: 0.28 });
        gl.depthFunc(gl.LEQUAL);
        lines(this.lines, { wide: 2 * ratio, cover: 1 });
        gl.depthFunc(gl.LESS);
        if (this.points.count > 0) {
            gl.disable(gl.DEPTH_TEST);
            this.point.use({ clip: view.clip, wide: 8 * ratio, marks: MARKS.flatMap(channels) });
            gl.bindVertexArray(this.points.array);
            gl.drawArrays(gl.POINTS, 0, this.points.count);
            gl.enable(gl.DEPTH_TEST);
        }
        gl.depthMask(true);
        gl.disable(gl.BLEND);
    }
}
