// Draws meshes many times over, with one light and its shadows, by WebGL2.

import { look, product } from './camera.js';
import { attribute, depthMap, program } from './gl.js';
import { Marks } from './marks.js';
import { CORNER, cornersOf } from './normals.js';
import { colour, figures, GROUND, STATIC } from './palette.js';
import { SHADOW_FRAGMENT, SHAPE_FRAGMENT, SHAPE_VERTEX, SKY_FRAGMENT, SKY_VERTEX } from './shaders.js';

/** Numbers of a pose: position [m], rotation, 1 if asleep. */
export const POSE = 8;
/** Numbers of a look: colour, and the tone with `SELECTED` more where the shape is selected. */
const LOOK = 4;
const SELECTED = 16;

const SUN = [0.42, 0.8, 0.43];
const MAP = 2048;

export class Renderer {
    constructor(canvas) {
        const gl = canvas.getContext('webgl2', { antialias: true, alpha: false });
        if (!gl) throw new Error('this browser shows no WebGL2');
        [this.gl, this.canvas] = [gl, canvas];
        this.shape = program(gl, SHAPE_VERTEX, SHAPE_FRAGMENT);
        this.shade = program(gl, SHAPE_VERTEX, SHADOW_FRAGMENT);
        this.sky = program(gl, SKY_VERTEX, SKY_FRAGMENT);
        this.shadows = depthMap(gl, MAP);
        this.marks = new Marks(gl);
        this.empty = gl.createVertexArray();
        [this.poses, this.looks] = [gl.createBuffer(), gl.createBuffer()];
        // Colours come multiplied by their cover.
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        [this.groups, this.links, this.order, this.tones] = [[], [], [], []];
        this.models = new Map();
        this.options = { dims: true, wireframe: false, shapes: true };
    }

    /**
     * `meshes`: corners of triangles, three numbers each, counter-clockwise from outside. `instances`: mesh and
     * tone of each shape, two numbers each. `links`: pairs of shapes with a line between them.
     */
    setScene(meshes, instances, links) {
        const { gl } = this;
        this.groups.forEach((group) => gl.deleteVertexArray(group.array));
        // Meshes that are still there are not made anew.
        const kept = new Set(meshes);
        for (const [mesh, { corners }] of this.models) {
            if (kept.has(mesh)) continue;
            gl.deleteBuffer(corners);
            this.models.delete(mesh);
        }
        const count = instances.length / 2;
        this.tones = Array.from({ length: count }, (_, i) => instances[2 * i + 1]);
        const kind = (i) => 16 * instances[2 * i] + this.tones[i];
        this.order = Array.from({ length: count }, (_, i) => i).sort((a, b) => kind(a) - kind(b));
        [this.links, this.anchors] = [links, new Float32Array(0)];
        this.sorted = new Float32Array(POSE * count);
        this.latest = new Float32Array(POSE * count);
        this.figures = figures(this.tones, links);
        [this.tints, this.selected] = [null, null];
        gl.bindBuffer(gl.ARRAY_BUFFER, this.poses);
        gl.bufferData(gl.ARRAY_BUFFER, this.sorted.byteLength, gl.DYNAMIC_DRAW);
        this.paint();
        [this.groups, this.reach] = [[], new Float32Array(count)];
        for (let first = 0; first < count; ) {
            const mesh = instances[2 * this.order[first]];
            let end = first;
            while (end < count && kind(this.order[end]) === kind(this.order[first])) end++;
            if (meshes[mesh].length > 0) this.groups.push(this.group(meshes[mesh], first, end - first));
            const { reach } = this.model(meshes[mesh]);
            for (let i = first; i < end; i++) this.reach[this.order[i]] = reach;
            first = end;
        }
    }

    /** A mesh on the graphics card. */
    model(mesh) {
        const known = this.models.get(mesh);
        if (known) return known;
        const { gl } = this;
        const corners = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, corners);
        gl.bufferData(gl.ARRAY_BUFFER, cornersOf(mesh), gl.STATIC_DRAW);
        const wide = Math.max(...[0, 1, 2].map((axis) => extent(mesh, axis)));
        let reach = 0;
        for (let i = 0; i < mesh.length; i += 3) reach = Math.max(reach, Math.hypot(mesh[i], mesh[i + 1], mesh[i + 2]));
        const model = { corners, wide, reach, vertices: mesh.length / 3 };
        this.models.set(mesh, model);
        return model;
    }

    /** A mesh with the places of its instances. */
    group(mesh, first, count) {
        const { gl } = this;
        const model = this.model(mesh);
        const array = gl.createVertexArray();
        gl.bindVertexArray(array);
        gl.bindBuffer(gl.ARRAY_BUFFER, model.corners);
        attribute(gl, 0, 3, 4 * CORNER, 0, 0);
        attribute(gl, 1, 3, 4 * CORNER, 12, 0);
        attribute(gl, 6, 3, 4 * CORNER, 24, 0);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.poses);
        const offset = 4 * POSE * first;
        attribute(gl, 2, 3, 4 * POSE, offset, 1);
        attribute(gl, 3, 4, 4 * POSE, offset + 12, 1);
        attribute(gl, 4, 1, 4 * POSE, offset + 28, 1);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.looks);
        attribute(gl, 5, LOOK, 4 * LOOK, 4 * LOOK * first, 1);
        return { ...model, array, count, tone: this.tones[this.order[first]] };
    }

    /** The colour of a shape. */
    colourOf(i) {
        if (this.tints?.[i] >= 0) return this.shades[this.tints[i]];
        return colour(this.tones[i], this.figures[i], i);
    }

    /** Gives all shapes their colours. */
    paint() {
        const { gl } = this;
        const looks = new Float32Array(LOOK * this.order.length);
        this.order.forEach((i, at) => {
            const marked = this.selected?.(i) ? SELECTED : 0;
            looks.set([...this.colourOf(i), this.tones[i] + marked], LOOK * at);
        });
        gl.bindBuffer(gl.ARRAY_BUFFER, this.looks);
        gl.bufferData(gl.ARRAY_BUFFER, looks, gl.DYNAMIC_DRAW);
    }

    /** An index of `tones`, colours of 0 to 255, for each shape, or -1: its own. All have their own without. */
    setTints(tints, tones = []) {
        if (!tints && !this.tints) return;
        this.tints = tints;
        // Large faces want duller colours than lines.
        this.shades = tones.map((tone) => tone.map((x) => 0.14 + (0.72 * x) / 255));
        this.paint();
    }

    /** Which shapes are selected, by their indices; none without. */
    select(selected) {
        this.selected = selected;
        this.paint();
    }

    /** Where all shapes are, in the order of the scene's instances: `POSE` numbers each. */
    setPoses(poses) {
        this.latest.set(poses);
        this.order.forEach((from, to) => {
            for (let k = 0; k < POSE; k++) this.sorted[POSE * to + k] = poses[POSE * from + k];
        });
        const { gl } = this;
        gl.bindBuffer(gl.ARRAY_BUFFER, this.poses);
        gl.bufferSubData(gl.ARRAY_BUFFER, 0, this.sorted);
    }

    /** Places and reach of what can move and is awake, or of all that can move if nothing is awake. */
    moving() {
        const places = (wanted) => {
            const found = [];
            for (let i = 0; i < this.tones.length; i++) {
                const pose = this.latest.subarray(POSE * i, POSE * (i + 1));
                if (this.tones[i] < STATIC && wanted(pose)) found.push([pose[0], pose[1], pose[2], this.reach[i]]);
            }
            return found;
        };
        const awake = places((pose) => pose[7] === 0);
        return awake.length > 0 ? awake : places(() => true);
    }

    draw(view) {
        const { gl, canvas } = this;
        const light = this.drawShadows(view);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.disable(gl.DEPTH_TEST);
        this.sky.use({ height: canvas.height });
        gl.bindVertexArray(this.empty);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        gl.enable(gl.DEPTH_TEST);
        gl.clear(gl.DEPTH_BUFFER_BIT);
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D, this.shadows.texture);
        const { dims, wireframe, shapes } = this.options;
        this.shape.use({
            ...view,
            sun: SUN,
            height: canvas.height,
            sunlight: light.clip,
            texel: light.texel,
            dims: Number(dims),
            wire: Number(wireframe),
        });
        this.shape.use({ glass: 0 });
        this.drawGroups(this.shape, view, () => shapes);
        this.drawMarks(view);
        this.shape.use({ glass: 1 });
        gl.enable(gl.BLEND);
        gl.depthMask(false);
        this.drawGroups(this.shape, view, (group) => shapes && group.tone === STATIC);
        gl.depthMask(true);
        gl.disable(gl.BLEND);
    }

    drawShadows(view) {
        const { gl } = this;
        // Covers what is framed and a little around it. Its size has steps, and its place those of whole
        // texels: edges of shadows stay still while the camera moves.
        const reach = 2 ** (Math.ceil(3 * Math.log2(1.7 * view.radius)) / 3);
        const texel = (2 * reach) / MAP;
        const turn = look([0, 0, 0], SUN);
        const along = (row) => turn[row] * view.target[0] + turn[4 + row] * view.target[1] + turn[8 + row] * view.target[2];
        const snapped = [0, 1].map((row) => Math.round(along(row) / texel) * texel);
        const s = 1 / reach;
        const deep = 1 / (3 * reach);
        const box = [s, 0, 0, 0, 0, s, 0, 0, 0, 0, -deep, 0, -snapped[0] * s, -snapped[1] * s, along(2) * deep, 1];
        const clip = product(box, turn);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadows.frame);
        gl.viewport(0, 0, MAP, MAP);
        gl.enable(gl.DEPTH_TEST);
        gl.clear(gl.DEPTH_BUFFER_BIT);
        gl.enable(gl.POLYGON_OFFSET_FILL);
        gl.polygonOffset(1.5, 2);
        this.shade.use({ clip, eye: view.eye, pixel: view.pixel });
        // Walls that are not drawn would shade what is between them.
        this.drawGroups(this.shade, view, (group) => group.tone !== STATIC || group.wide < 0.5 * view.radius);
        gl.disable(gl.POLYGON_OFFSET_FILL);
        return { clip, texel };
    }

    drawGroups(shader, view, wanted) {
        const { gl } = this;
        for (const group of this.groups.filter(wanted)) {
            (group.tone >= GROUND || this.options.wireframe ? gl.disable : gl.enable).call(gl, gl.CULL_FACE);
            shader.use({ wide: group.wide, large: group.wide < 0.5 * view.radius ? 0 : 1 });
            gl.bindVertexArray(group.array);
            gl.drawArraysInstanced(gl.TRIANGLES, 0, group.vertices, group.count);
        }
        gl.disable(gl.CULL_FACE);
    }

    /** Ends of the lines that show joints: from bodies to where they are joined, if that is known. */
    joints() {
        const { links, anchors, latest, tones } = this;
        const at = (numbers, from) => numbers.subarray(from, from + 3);
        const ends = [];
        for (let k = 0; k + 1 < links.length; k += 2) {
            const way = [at(latest, POSE * links[k]), at(latest, POSE * links[k + 1])];
            const known = anchors.length === 3 * links.length;
            if (known) way.splice(1, 0, at(anchors, 3 * k), at(anchors, 3 * k + 3));
            // The middle of something large says nothing.
            const least = known ? STATIC : GROUND;
            if (tones[links[k]] >= least) way.shift();
            if (tones[links[k + 1]] >= least) way.pop();
            for (let i = 0; i + 1 < way.length; i++) if (Number.isFinite(way[i][0])) ends.push(way[i], way[i + 1]);
        }
        return ends;
    }

    drawMarks(view) {
        const { canvas } = this;
        this.marks.setLinks(this.joints());
        const ratio = Math.max(1, canvas.width / (canvas.clientWidth || 1));
        this.marks.draw(view, [canvas.width, canvas.height], ratio);
    }
}

/** Half of the extent of a mesh along an axis; not zero. */
function extent(mesh, axis) {
    let [low, high] = [Infinity, -Infinity];
    for (let i = axis; i < mesh.length; i += 3) [low, high] = [Math.min(low, mesh[i]), Math.max(high, mesh[i])];
    return Math.max(1e-4, 0.5 * (high - low));
}
