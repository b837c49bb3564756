// Draws meshes many times over, with one light and its shadows, by WebGL2.

import { look, product } from './camera.js';
import { CORNER, cornersOf } from './normals.js';
import { MARK_FRAGMENT, MARK_VERTEX, SHADOW_FRAGMENT, SHAPE_FRAGMENT, SHAPE_VERTEX, SKY_FRAGMENT, SKY_VERTEX } from './shaders.js';

/**
 * Colours: sphere, capsule, box, cylinder and cone, hull; kinematic; static; and ground that is seen from both
 * sides: planes, meshes, height fields.
 */
export const TONES = ['#d9604c', '#e3a23c', '#4d82c4', '#57a773', '#8f6fc0', '#3aa39a', '#c3c7cd', '#cfd2cc'];
/** Colours of points: real, potential, ghost; and of joints. */
export const MARKS = ['#c3121f', '#1668d8', '#d613b5', '#30363d'];
/** Numbers of a pose: position [m], rotation, 1 if asleep. */
export const POSE = 8;
const GROUND = 7;
const STATIC = 6;

const SUN = [0.42, 0.8, 0.43];
const MAP = 2048;

const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

export class Renderer {
    constructor(canvas) {
        const gl = canvas.getContext('webgl2', { antialias: true, alpha: false });
        if (!gl) throw new Error('this browser shows no WebGL2');
        [this.gl, this.canvas] = [gl, canvas];
        this.shape = program(gl, SHAPE_VERTEX, SHAPE_FRAGMENT);
        this.shade = program(gl, SHAPE_VERTEX, SHADOW_FRAGMENT);
        this.sky = program(gl, SKY_VERTEX, SKY_FRAGMENT);
        this.mark = program(gl, MARK_VERTEX, MARK_FRAGMENT);
        this.shadows = shadowMap(gl);
        this.empty = gl.createVertexArray();
        this.poses = gl.createBuffer();
        this.marks = { buffer: gl.createBuffer(), array: gl.createVertexArray() };
        gl.bindVertexArray(this.marks.array);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.marks.buffer);
        attribute(gl, 0, 4, 16, 0, 0);
        // Colours come multiplied by their cover.
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        this.groups = [];
        this.links = [];
        this.points = new Float32Array(0);
    }

    /**
     * `meshes`: corners of triangles, three numbers each, counter-clockwise from outside. `instances`: mesh and
     * tone of each shape, two numbers each. `links`: pairs of shapes with a line between them.
     */
    setScene(meshes, instances, links) {
        const { gl } = this;
        for (const group of this.groups) {
            gl.deleteVertexArray(group.array);
            gl.deleteBuffer(group.corners);
        }
        const count = instances.length / 2;
        this.order = Array.from({ length: count }, (_, i) => i).sort((a, b) => instances[2 * a] - instances[2 * b]);
        this.tones = Array.from({ length: count }, (_, i) => instances[2 * i + 1]);
        this.links = links;
        this.sorted = new Float32Array(POSE * count);
        this.latest = new Float32Array(POSE * count);
        this.points = new Float32Array(0);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.poses);
        gl.bufferData(gl.ARRAY_BUFFER, this.sorted.byteLength, gl.DYNAMIC_DRAW);
        // Neighbours of a kind differ a little, so that they can be told apart.
        const tint = (i) => (((i * 0.618034) % 1) - 0.5) * 2;
        this.looks ??= gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, this.looks);
        const looks = this.order.flatMap((i) => [this.tones[i], tint(i)]);
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(looks), gl.STATIC_DRAW);
        this.groups = [];
        for (let first = 0; first < count; ) {
            const mesh = instances[2 * this.order[first]];
            let end = first;
            while (end < count && instances[2 * this.order[end]] === mesh) end++;
            this.groups.push(this.group(meshes[mesh], first, end - first));
            first = end;
        }
    }

    /** A mesh with the places of its instances. */
    group(mesh, first, count) {
        const { gl } = this;
        const array = gl.createVertexArray();
        const corners = gl.createBuffer();
        gl.bindVertexArray(array);
        gl.bindBuffer(gl.ARRAY_BUFFER, corners);
        gl.bufferData(gl.ARRAY_BUFFER, cornersOf(mesh), gl.STATIC_DRAW);
        attribute(gl, 0, 3, 4 * CORNER, 0, 0);
        attribute(gl, 1, 3, 4 * CORNER, 12, 0);
        attribute(gl, 6, 3, 4 * CORNER, 24, 0);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.poses);
        const offset = 4 * POSE * first;
        attribute(gl, 2, 3, 4 * POSE, offset, 1);
        attribute(gl, 3, 4, 4 * POSE, offset + 12, 1);
        attribute(gl, 4, 1, 4 * POSE, offset + 28, 1);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.looks);
        attribute(gl, 5, 2, 8, 8 * first, 1);
        const wide = Math.max(...[0, 1, 2].map((axis) => extent(mesh, axis)));
        const tone = this.tones[this.order[first]];
        return { array, corners, vertices: mesh.length / 3, count, wide, tone };
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

    /** Places of what can move and is awake, or of all that can move if nothing is awake. */
    moving() {
        const places = (wanted) => {
            const found = [];
            for (let i = 0; i < this.tones.length; i++) {
                const pose = this.latest.subarray(POSE * i, POSE * (i + 1));
                if (this.tones[i] < STATIC && wanted(pose)) found.push([pose[0], pose[1], pose[2]]);
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
        this.shape.use({
            ...view,
            tones: TONES.flatMap(rgb),
            sun: SUN,
            height: canvas.height,
            sunlight: light.clip,
            texel: light.texel,
        });
        this.shape.use({ glass: 0 });
        this.drawGroups(this.shape, view, () => true);
        this.drawMarks(view);
        this.shape.use({ glass: 1 });
        gl.enable(gl.BLEND);
        gl.depthMask(false);
        this.drawGroups(this.shape, view, (group) => group.tone === STATIC);
        gl.depthMask(true);
        gl.disable(gl.BLEND);
    }

    drawShadows(view) {
        const { gl } = this;
        // Covers what is framed and a little around it, in steps of whole texels: edges of shadows stay still.
        const reach = 1.7 * view.radius;
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
            (group.tone === GROUND ? gl.disable : gl.enable).call(gl, gl.CULL_FACE);
            shader.use({ wide: group.wide, large: group.wide < 0.5 * view.radius ? 0 : 1 });
            gl.bindVertexArray(group.array);
            gl.drawArraysInstanced(gl.TRIANGLES, 0, group.vertices, group.count);
        }
        gl.disable(gl.CULL_FACE);
    }

    drawMarks(view) {
        const { gl } = this;
        const at = (shape) => [...this.latest.subarray(POSE * shape, POSE * shape + 3), 3];
        const lines = new Float32Array(Array.from(this.links).flatMap(at));
        const ratio = Math.max(1, this.canvas.width / (this.canvas.clientWidth || 1));
        this.mark.use({ clip: view.clip, size: 6 * ratio, marks: MARKS.flatMap(rgb) });
        gl.bindVertexArray(this.marks.array);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.marks.buffer);
        gl.bufferData(gl.ARRAY_BUFFER, lines, gl.STREAM_DRAW);
        gl.drawArrays(gl.LINES, 0, lines.length / 4);
        gl.disable(gl.DEPTH_TEST);
        gl.enable(gl.BLEND);
        gl.bufferData(gl.ARRAY_BUFFER, this.points, gl.STREAM_DRAW);
        gl.drawArrays(gl.POINTS, 0, this.points.length / 4);
        gl.disable(gl.BLEND);
        gl.enable(gl.DEPTH_TEST);
    }
}

/** Half of the extent of a mesh along an axis; not zero. */
function extent(mesh, axis) {
    let [low, high] = [Infinity, -Infinity];
    for (let i = axis; i < mesh.length; i += 3) [low, high] = [Math.min(low, mesh[i]), Math.max(high, mesh[i])];
    return Math.max(1e-4, 0.5 * (high - low));
}

function attribute(gl, location, size, stride, offset, divisor) {
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(location, divisor);
}

function shadowMap(gl) {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT32F, MAP, MAP);
    for (const [name, value] of [
        [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
        [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
        [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
        [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
        [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ]) {
        gl.texParameteri(gl.TEXTURE_2D, name, value);
    }
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    return { texture, frame };
}

/** A program whose `use` sets uniforms by name; names that it doesn't have are left out. */
function program(gl, vertex, fragment) {
    const made = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    const setters = new Map();
    for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i++) {
        const { name, type } = gl.getActiveUniform(made, i);
        const at = gl.getUniformLocation(made, name);
        const set = {
            [gl.FLOAT]: (v) => gl.uniform1f(at, v),
            [gl.FLOAT_VEC3]: (v) => gl.uniform3fv(at, v),
            [gl.FLOAT_MAT4]: (v) => gl.uniformMatrix4fv(at, false, v),
        };
        setters.set(name.replace('[0]', ''), set[type] ?? (() => {}));
    }
    return {
        use(values) {
            gl.useProgram(made);
            for (const [name, value] of Object.entries(values)) setters.get(name)?.(value);
        },
    };
}
