// Requests to the engine, which runs as a program of this machine or as WebAssembly in a worker.

/** What an answer says: its header, and `numbers(name)` for its sections, which are empty where it has none. */
class Answer {
    constructor(buffer) {
        const length = new DataView(buffer).getUint32(0, true);
        [this.buffer, this.start] = [buffer, 4 + length];
        this.header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
        this.sections = new Map(this.header.sections.map((section) => [section.name, section]));
    }

    has(name) {
        return this.sections.has(name);
    }

    numbers(name) {
        const { offset, count } = this.sections.get(name) ?? { offset: 0, count: 0 };
        return new Float32Array(this.buffer, this.start + offset, count);
    }
}

/** The engine behind the server that the page comes from. */
class Native {
    async send(text) {
        const response = await fetch('frame', { method: 'POST', body: text });
        if (!response.ok) throw new Error(`the testbed answers ${response.status} ${await response.text()}`);
        return response.arrayBuffer();
    }
}

/** The engine as `backstop.wasm`, in a worker: a long step doesn't stop the page. */
class Wasm {
    static async start() {
        const worker = new Worker(new URL('worker.js', import.meta.url));
        const engine = new Wasm(worker);
        await engine.reply();
        return engine;
    }

    constructor(worker) {
        this.worker = worker;
    }

    /** The worker's next message. */
    reply() {
        return new Promise((done, failed) => {
            this.worker.onmessage = ({ data }) => (data.failed ? failed(new Error(data.failed)) : done(data));
            this.worker.onerror = (event) => failed(new Error(event.message ?? 'the worker stopped'));
        });
    }

    send(text) {
        const reply = this.reply();
        this.worker.postMessage(text);
        return reply;
    }
}

/** One request after the other. */
export class Engine {
    /** `kind`: `native` or `wasm`. */
    static async start(kind) {
        return new Engine(kind, kind === 'wasm' ? await Wasm.start() : new Native());
    }

    constructor(kind, back) {
        [this.kind, this.back, this.turn] = [kind, back, Promise.resolve()];
    }

    /** Its answer; requests that are made meanwhile wait for it. */
    request(request) {
        const sent = async () => new Answer(await this.back.send(JSON.stringify(request)));
        const answer = this.turn.then(sent);
        this.turn = answer.catch(() => {});
        return answer;
    }
}
