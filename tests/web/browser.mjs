// A server on this machine, and Debian's Chromium, without a GPU, on a page of it, which posts what it found to /results.
import {spawn} from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import {DevTools} from './devtools.mjs';

const kMost_s = 240;
const kTypes = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.json': 'application/json',
                '.png': 'image/png', '.svg': 'image/svg+xml', '.gltf': 'model/gltf+json'};
const kPolicy = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self'; worker-src 'self'; img-src 'self'; media-src 'self'";

// The file of the first root whose prefix a name begins with; null: there is none.
function file(name, roots) {
    const [prefix, root] = roots.find(([start]) => name.startsWith(start));
    const found = path.join(root, path.normalize('/' + name.slice(prefix.length)));
    return fs.existsSync(found) && fs.statSync(found).isFile() ? fs.readFileSync(found) : null;
}

/** Answers as a server of ranges does; as one that has none, for names in /whole/. */
export function answer(request, response, name, content) {
    const range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
    const headers = {'Content-Type': kTypes[path.extname(name)] ?? 'application/octet-stream', 'Content-Security-Policy': kPolicy};
    if (!content) return response.writeHead(404, headers).end();
    if (!range || name.startsWith('/whole/')) return response.writeHead(200, headers).end(content);
    if (Number(range[1]) >= content.length) return response.writeHead(416, headers).end();
    const part = content.subarray(Number(range[1]), Number(range[2]) + 1);
    headers['Content-Range'] = `bytes ${range[1]}-${Number(range[1]) + part.length - 1}/${content.length}`;
    response.writeHead(206, headers).end(part);
}

/**
 * A server on this machine: {address, asked, missing, close}. `asked`: names of requests that were answered, `missing`: of the
 * others. `roots`: [prefix of names, folder]; `sent`: bytes by name, before those; `replies`: functions by name, which make the
 * answer of what is posted there; `fail` is called with what they throw. `serve`: answers instead of `answer`.
 */
export async function serving({roots, sent = {}, replies = {}, fail = () => {}, serve = answer}) {
    const asked = [], missing = [];
    const server = http.createServer((request, response) => {
        const name = new URL(request.url, 'http://x').pathname, reply = replies[name];
        if (reply) {
            let body = '';
            request.on('data', part => body += part).on('end', async () => {
                try {
                    response.end(await reply(JSON.parse(body)));
                } catch (error) {
                    response.writeHead(500).end();
                    fail(`${name}: ${error.message}`);
                }
            });
            return;
        }
        const content = sent[name] ?? file(name, roots);
        (content ? asked : missing).push(name);
        serve(request, response, name, content);
    });
    await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
    const close = () => {
        server.close();
        server.closeAllConnections();  // those that were not answered
    };
    return {address: `http://127.0.0.1:${server.address().port}`, asked, missing, close};
}

/** Chromium: {browser, devTools, log, end}. `log()` is what it has said, `end()` resolves when it and its files are gone. */
export function started(flags) {
    const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'neuvv-chromium-'));
    const browser = spawn('chromium', ['--headless=new', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
        '--disable-dev-shm-usage', `--user-data-dir=${profile}`, '--no-first-run', '--remote-debugging-pipe',
        '--autoplay-policy=no-user-gesture-required', ...flags],
        {stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe'], detached: true});  // a group of its own, which is ended as a whole
    let log = '';
    browser.stderr.on('data', text => log += text);
    const end = async () => {
        if (browser.exitCode === null) {
            const exited = new Promise(resolve => browser.on('exit', resolve));
            process.kill(-browser.pid, 'SIGKILL');
            await exited;
        }
        await fs.promises.rm(profile, {recursive: true, force: true, maxRetries: 20, retryDelay: 100});  // some may still write
    };
    return {browser, devTools: new DevTools(browser.stdio[3], browser.stdio[4]), log: () => log, end};
}

/**
 * What a page posts: {results, asked, missing}; `results` has `problem` where nothing came in `most_s` seconds. `answers`: see
 * `replies` of serving(); they get the DevTools, too; `flags`: of Chromium.
 */
export async function resultsOf({page, roots, sent, answers = {}, serve, most_s = kMost_s, flags = []}) {
    let finish, devTools;
    const finished = new Promise(resolve => finish = resolve), replies = {'/results': finish};
    for (const [name, reply] of Object.entries(answers)) replies[name] = body => reply(body, devTools);
    const server = await serving({roots, sent, replies, serve, fail: problem => finish({problem})});
    const {browser, log, end, ...more} = started([...flags, `${server.address}${page}`]);
    devTools = more.devTools;
    browser.on('exit', code => finish({problem: `chromium ended with ${code}\n${log()}`}));
    const timer = setTimeout(() => finish({problem: `nothing came in ${most_s} s\n${log()}`}), 1000 * most_s);
    const results = await finished;
    clearTimeout(timer);
    await end();
    server.close();
    return {results, asked: server.asked, missing: server.missing.filter(name => name !== '/favicon.ico')};
}
