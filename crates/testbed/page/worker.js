// The engine as WebAssembly: a message is a request, and is answered by a message.

const engine = (async () => {
    const response = await fetch('backstop.wasm');
    if (!response.ok) throw new Error(`backstop.wasm: ${response.status}`);
    const imports = { testbed: { now: () => performance.now() } };
    const { instance } = await WebAssembly.instantiate(await response.arrayBuffer(), imports);
    return instance.exports;
})();

/** The bytes of the answer to a request. */
function answer(engine, text) {
    const request = new TextEncoder().encode(text);
    const at = engine.reserve(request.length);
    new Uint8Array(engine.memory.buffer, at, request.length).set(request);
    const length = engine.request(request.length);
    const start = engine.answer();
    return engine.memory.buffer.slice(start, start + length);
}

const failed = (error) => postMessage({ failed: String(error.message ?? error) });

onmessage = async ({ data }) => {
    try {
        const bytes = answer(await engine, data);
        postMessage(bytes, [bytes]);
    } catch (error) {
        failed(error);
    }
};

engine.then(() => postMessage({ ready: true }), failed);
