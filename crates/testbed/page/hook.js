// `globalThis.testbed`: the page for tests, for programs that make pictures, and for the console.

/** Steps of one request: the engine answers between them. */
const CHUNK = 60;

/** What the picture has in it: how many colours, a sum that another picture hardly has, and WebGL's error. */
function pixels({ gl }) {
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const bytes = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    const words = new Uint32Array(bytes.buffer);
    let sum = 0;
    for (const word of words) sum = (Math.imul(sum, 31) + word) | 0;
    return { colours: new Set(words).size, height, sum, error: gl.getError() };
}

export function hook(app) {
    const { loop, view } = app;
    return {
        app,
        /** The entries of the catalogue. */
        get catalogue() {
            return app.samples.catalogue;
        },
        /** The header of the last answer. */
        get header() {
            return app.header;
        },
        /** Numbers of all poses. */
        get poses() {
            return view.renderer.latest;
        },
        /** Opens a sample, and waits; it does not play unless that is asked for. */
        async open(name, options = {}) {
            await app.open(name, { play: false, ...options });
            return app.header;
        },
        /** Does commands, at once. */
        async do(...commands) {
            return (await loop.send({ commands, want: ['ledger'] })).header;
        },
        /** Makes steps, and waits; an error ends them. */
        async step(count = 1) {
            app.transport.play(false);
            for (let left = count; left > 0; left -= CHUNK) {
                const { header } = await loop.send({ steps: Math.min(left, CHUNK), want: left > CHUNK ? [] : ['ledger'] });
                if (header.error) break;
            }
            return app.header;
        },
        async back(steps = 1) {
            return this.do({ do: 'back', steps });
        },
        async seek(step) {
            return this.do({ do: 'seek', step });
        },
        play(playing = true) {
            app.transport.play(playing);
        },
        /** Looks from one place to another, and stays; frames what moves without them. */
        camera({ eye, lookAt } = {}) {
            if (!eye || !lookAt) return view.home();
            view.camera.between(eye, lookAt);
            return view.moved(true);
        },
        /** Shows these layers alone, and waits. */
        async layers(names) {
            await app.setLayers(names);
        },
        /** Whether pictures are drawn only by `draw`. */
        still(still) {
            view.still = still;
        },
        /** Whether there is nothing but the picture. */
        bare(bare) {
            document.body.classList.toggle('bare', bare);
        },
        /** Draws; what the picture has in it. */
        draw() {
            view.draw();
            return pixels(view.renderer);
        },
        /** Draws, and waits until it is seen. */
        async screenshotReady() {
            view.draw();
            await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
        },
    };
}
