// The player in a tab of Chromium that is hidden, or that sleeps, and shown again.
//   node tests/web/hidden.mjs NEUVV BUILT STREAM
// BUILT: what tools/web/build made. Exits with 1 where something is wrong.
import fs from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {answer, resultsOf} from './browser.mjs';
import {repeatedGroup, tone} from './streams.mjs';

const [, built, stream] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const kAnswer_ms = 300;  // so long that something is always asked for
const later = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));

// Another tab comes in front, and goes.
let other = null;
async function hide(words, devTools) {
    await devTools.page();  // while it is the only one
    other = await devTools.call('Target.createTarget', {url: 'about:blank'});
    return '';
}
async function show(words, devTools) {
    await devTools.call('Target.activateTarget', await devTools.page());
    await devTools.call('Target.closeTarget', other);
    return '';
}
// Nothing runs in it for some seconds, as in tabs that were hidden for long and on machines that sleep.
async function sleep({seconds}, devTools) {
    const {sessionId} = await devTools.page(), state = name => devTools.call('Page.setWebLifecycleState', {state: name}, sessionId);
    await hide({}, devTools);
    await state('frozen');
    await later(1000 * seconds);
    await state('active');
    return show({}, devTools);
}

const fps = 20, times = 600, sent = {'/stream.nvs': repeatedGroup(fs.readFileSync(stream), times, fps, await import(path.resolve(built, 'nvs.js')))};
sent['/stream.m4a'] = tone(2 * times / fps);
const serve = (...words) => setTimeout(() => answer(...words), kAnswer_ms);
const {results, missing} = await resultsOf({page: '/test/hidden.html', roots: [['/test/', here], ['/', built]], sent, serve,
                                            answers: {'/hide': hide, '/show': show, '/sleep': sleep}});
if (results.problem) results.wrong = [...results.wrong ?? [], results.problem];
if (missing.length > 0) results.wrong.push(`asked for ${missing}`);
console.log(results.counts);
for (const text of results.wrong) console.error(`wrong: ${text}`);
process.exit(results.wrong.length > 0 ? 1 : 0);
