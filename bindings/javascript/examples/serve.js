// npm run demo: serves the package for examples/page.html, with the headers
// that allow shared memory (or without, with --plain).
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const root = fileURLToPath(new URL('..', import.meta.url));
const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };

/** Listens on a free port of this machine, or on the given one. */
export async function serve({ isolated = true, port = 0 } = {}) {
    const server = createServer(async (request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, 'http://here').pathname));
        const type = types[extname(path)];
        try {
            if (!type || !/^[/\\](examples|lib|dist)[/\\]/.test(path)) throw new Error('not part of the page');
            const content = await readFile(join(root, path));
            response.writeHead(200, {
                'content-type': type,
                'cache-control': 'no-store',
                ...(isolated && { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' }),
            });
            response.end(content);
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise(resolve => server.listen(port, '127.0.0.1', resolve));
    return { server, address: `http://127.0.0.1:${server.address().port}/examples/page.html` };
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
    const { address } = await serve({ isolated: !process.argv.includes('--plain'), port: Number(process.env.PORT ?? 8080) });
    console.log(address);
}
