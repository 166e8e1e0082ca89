// How the player's bar, its messages and the page of stages look in Chromium, by screenshots.
//   node tests/web/looks.mjs NEUVV BUILT STREAM [FOLDER]
// BUILT: what tools/web/build made; with three.js, the page of stages is looked at, too. FOLDER: where the screenshots are
// left. Exits with 1 where something is wrong.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {resultsOf} from './browser.mjs';
import {repeatedGroup, tone} from './streams.mjs';

const kTimes = 8, kFps = 4;  // so that the bar says tenths of seconds
const [neuvv, built, stream, given] = process.argv.slice(2);
const folder = given ?? fs.mkdtempSync(path.join(os.tmpdir(), 'neuvv-looks-'));
fs.mkdirSync(folder, {recursive: true});
const here = path.dirname(fileURLToPath(import.meta.url));
const bytes = repeatedGroup(fs.readFileSync(stream), kTimes, kFps, await import(path.resolve(built, 'nvs.js')));

// A stage of the stream, and of one that is not there.
function makeStage() {
    const run = words => execFileSync(neuvv, ['stage', ...words], {cwd: folder, stdio: 'ignore'});
    fs.writeFileSync(path.join(folder, 'stream.nvs'), bytes);
    run(['new', 'show.gltf', '--overwrite']);
    for (const name of ['anna', 'berta']) run(['add', 'show.gltf', 'stream.nvs', '--name', name, '--time', 'loop']);
    const json = JSON.parse(fs.readFileSync(path.join(folder, 'show.gltf')));
    json.nodes.find(({name}) => name === 'berta').extensions.NEUVV_performer.uri = 'missing.nvs';
    fs.writeFileSync(path.join(folder, 'show.gltf'), JSON.stringify(json));
}
async function setSize({width, height}, devTools) {
    const {sessionId} = await devTools.page();
    await devTools.call('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: false}, sessionId);
    return '';
}
async function screenshot({name}, devTools) {
    const {sessionId} = await devTools.page(), {data} = await devTools.call('Page.captureScreenshot', {format: 'png'}, sessionId);
    const png = Buffer.from(data, 'base64');
    fs.writeFileSync(path.join(folder, `${name}.png`), png);
    return png;
}

const hasStages = fs.existsSync(path.join(built, 'stage', 'three.module.js'));
if (hasStages) makeStage();
const roots = [['/test/', here], ['/views/', folder], ['/', built]], sent = {'/stream.nvs': bytes, '/stream.m4a': tone(2 * kTimes / kFps)};
const page = `/test/looks.html?src=/views/${hasStages ? 'show.gltf' : ''}`;
const {results} = await resultsOf({page, roots, sent, answers: {'/size': setSize, '/screenshot': screenshot}});
if (results.problem) results.wrong = [...results.wrong ?? [], results.problem];
if (!hasStages) console.log('the page of stages was not looked at: three.js is not installed');
if (!given) fs.rmSync(folder, {recursive: true});
for (const text of results.wrong) console.error(`wrong: ${text}`);
process.exit(results.wrong.length > 0 ? 1 : 0);
