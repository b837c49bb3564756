// A static server for this machine alone: node bindings/web/serve.mjs [PORT]
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname } from 'node:path';
import { fileURLToPath } from 'node:url';

const ROOT = new URL('../../target/web/', import.meta.url);
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };

/** Serves the page; port 0 is any that is free. */
export function serve(port) {
    const server = createServer(async (request, response) => {
        // The path of an address has no `..` in it any more.
        const name = new URL(request.url, 'http://localhost').pathname.slice(1) || 'index.html';
        try {
            const body = await readFile(new URL(`./${name}`, ROOT));
            response.writeHead(200, {
                'content-type': TYPES[extname(name)] ?? 'application/octet-stream',
                // A page by itself has a clock of 5 µs; others have one of 100 µs.
                'cross-origin-opener-policy': 'same-origin',
                'cross-origin-embedder-policy': 'require-corp',
            });
            response.end(body);
        } catch {
            response.writeHead(404).end();
        }
    });
    return new Promise((done) => server.listen(port, '127.0.0.1', () => done(server)));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
    const server = await serve(Number(process.argv[2] ?? 8080));
    console.log(`http://localhost:${server.address().port}/`);
}
