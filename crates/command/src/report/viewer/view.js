// A canvas with its camera: keeps its size, and draws when there is something new to see.

import { Camera, frameOf } from './camera.js';
import { Renderer } from './renderer.js';

export class View {
    constructor(canvas) {
        this.canvas = canvas;
        this.renderer = new Renderer(canvas);
        this.camera = new Camera();
        this.camera.attach(canvas, () => this.invalidate());
        new ResizeObserver(() => this.invalidate()).observe(canvas);
    }

    /** As for the renderer. The camera goes to the scene at once when it has its first poses. */
    setScene(meshes, instances, links) {
        this.renderer.setScene(meshes, instances, links);
        this.camera.reset();
        this.fresh = true;
    }

    /** `seconds`: since the last poses, for the camera to follow. */
    setPoses(poses, seconds) {
        this.renderer.setPoses(poses);
        const { camera, fresh } = this;
        camera.follow(frameOf(this.renderer.moving(), fresh ? undefined : camera.home), fresh ? undefined : seconds);
        this.fresh = false;
        this.invalidate();
    }

    setPoints(points) {
        this.renderer.points = points;
        this.invalidate();
    }

    invalidate() {
        this.pending ??= requestAnimationFrame(() => this.draw());
    }

    draw() {
        this.pending = undefined;
        const { canvas } = this;
        const ratio = Math.min(window.devicePixelRatio || 1, 2);
        const size = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
        if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
        this.renderer.draw(this.camera.view(...size));
    }
}
