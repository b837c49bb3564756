// A canvas with its camera: keeps its size, and draws when there is something new to see.

import { Camera, frameOf } from './camera.js';
import { orbit } from './orbit.js';
import { POSE, Renderer } from './renderer.js';

export class View {
    /** `hand`: as for `orbit`. `changed` is called when the user moved the camera. */
    constructor(canvas, hand, changed = () => {}) {
        [this.canvas, this.changed] = [canvas, changed];
        this.renderer = new Renderer(canvas);
        this.camera = new Camera();
        /** Whether the camera follows: what moves, or the shape of an index; or stays. */
        this.follows = 'moving';
        orbit(canvas, this, hand);
        new ResizeObserver(() => this.invalidate()).observe(canvas);
    }

    /** As for the renderer. The camera goes to the scene at once when it has its first poses, unless it `stays`. */
    setScene(meshes, instances, links, stays = false) {
        this.renderer.setScene(meshes, instances, links);
        if (stays) return;
        this.camera.reset();
        this.fresh = true;
    }

    /** `seconds`: since the last poses, for the camera to follow. */
    setPoses(poses, seconds) {
        this.renderer.setPoses(poses);
        const { camera } = this;
        if (this.fresh) camera.follow(frameOf(this.renderer.moving()));
        else if (this.follows === 'moving') camera.follow(frameOf(this.renderer.moving(), camera.home), seconds);
        else if (this.follows !== 'nothing') camera.accompany(this.place(this.follows), seconds);
        this.fresh = false;
        this.invalidate();
    }

    /** Where a shape is. */
    place(shape) {
        return this.renderer.latest.subarray(POSE * shape, POSE * shape + 3);
    }

    /** Takes back what the user turned, moved and zoomed, and frames what moves. */
    home() {
        this.camera.reset();
        this.camera.follow(frameOf(this.renderer.moving()));
        this.moved();
    }

    /** The camera was moved; `panned` is to another place. */
    moved(panned = false) {
        this.invalidate();
        this.changed(panned);
    }

    /** The ray from the eye through a place of the page. */
    ray(clientX, clientY) {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        const x = (2 * (clientX - left)) / width - 1;
        const y = 1 - (2 * (clientY - top)) / height;
        return this.camera.ray(x, y, width / height);
    }

    invalidate() {
        if (this.still) return;
        this.pending ??= requestAnimationFrame(() => this.draw());
    }

    draw() {
        if (this.pending !== undefined) cancelAnimationFrame(this.pending);
        this.pending = undefined;
        const { canvas } = this;
        const ratio = Math.min(window.devicePixelRatio || 1, 2);
        const size = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
        if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
        this.renderer.draw(this.camera.view(...size));
    }
}
