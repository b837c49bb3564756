// The engine's functions for JavaScript: text and lists of numbers out of linear memory.

export class Engine {
    /** From the address of the compiled module. */
    static async load(address) {
        const response = await fetch(address);
        if (!response.ok) throw new Error(`${address}: ${response.status}`);
        const { instance } = await WebAssembly.instantiate(await response.arrayBuffer(), {});
        return new Engine(instance.exports);
    }

    constructor(exports) {
        this.exports = exports;
        this.scenes = JSON.parse(this.text(exports.catalogue()));
    }

    text(length) {
        const { memory, text } = this.exports;
        return new TextDecoder().decode(new Uint8Array(memory.buffer, text(), length));
    }

    /** A view of the numbers of the last call, until the next one. */
    numbers(count) {
        const { memory, numbers } = this.exports;
        return new Float32Array(memory.buffer, numbers(), count);
    }

    /** Throws what was refused. */
    refusal(length) {
        if (length > 0) throw new Error(this.text(length));
    }

    open(scene, size, { substeps, iterations, sleeping }) {
        this.refusal(this.exports.open(scene, size, substeps, iterations, sleeping));
    }

    configure({ substeps, iterations, sleeping }) {
        this.refusal(this.exports.configure(substeps, iterations, sleeping));
    }

    /** Steps; returns the time that it took [ms]. The snapshot for the way back is not in it. */
    step() {
        this.exports.remember();
        const start = performance.now();
        const refused = this.exports.step();
        const time = performance.now() - start;
        this.refusal(refused);
        return time;
    }

    back() {
        this.refusal(this.exports.back());
    }

    report() {
        return JSON.parse(this.text(this.exports.report()));
    }

    meshes() {
        return Array.from({ length: this.exports.meshes() }, (_, i) => this.numbers(this.exports.mesh(i)).slice());
    }

    instances() {
        return this.numbers(this.exports.instances()).slice();
    }

    links() {
        return this.numbers(this.exports.links()).slice();
    }

    poses() {
        return this.numbers(this.exports.poses());
    }

    points() {
        return this.numbers(this.exports.points()).slice();
    }
}
