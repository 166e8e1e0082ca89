// The player in a headset that IWER simulates, in Chromium: each eye against `neuvv render`; hands that move and play.
//   node tests/web/headset.mjs NEUVV BUILT STREAM [FOLDER]
// BUILT: what tools/web/build made. FOLDER: where images are left. Exits with 1 where something is wrong.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {resultsOf} from './browser.mjs';
import {folderWith} from './modules.mjs';

const kLeast_db = 45;
const [neuvv, built, stream, given] = process.argv.slice(2);
const modules = folderWith('iwer'), folder = given ?? fs.mkdtempSync(path.join(os.tmpdir(), 'neuvv-web-'));
fs.mkdirSync(folder, {recursive: true});
const here = path.dirname(fileURLToPath(import.meta.url));

// The image of a camera, as the page asks for it.
function render({camera, frame, background, name}) {
    const image = path.join(folder, `${name}.png`), file = path.join(folder, `${name}.json`);
    fs.writeFileSync(file, JSON.stringify(camera));
    execFileSync(neuvv, ['render', stream, '-o', image, '--camera', file, '--frames', String(frame), '--background', background,
                         '--samples', '1', '--direct', '--overwrite'], {stdio: 'ignore'});
    return fs.readFileSync(image);
}

const roots = [['/test/', here], ['/modules/', modules], ['/', built]];
const {results} = await resultsOf({page: '/test/headset.html', roots, sent: {'/stream.nvs': fs.readFileSync(stream)}, answers: {'/render': render}});

const wrong = [];
const expect = (condition, text) => condition || wrong.push(text);
expect(!results.problem, results.problem);
for (const {eye, psnr_db} of results.eyes ?? []) {
    console.log(`${eye} eye: ${psnr_db.toFixed(2)} dB`);
    expect(psnr_db >= kLeast_db, `the ${eye} eye has ${psnr_db.toFixed(2)} dB`);
}
if (!results.problem) {
    for (const name of ['eyes', 'room'])
        fs.writeFileSync(path.join(folder, `${name}.png`), Buffer.from(results[`${name}_png`].split(',')[1], 'base64'));
    expect(results.eyes.length === 2, 'there are not two eyes');
    expect(results.swapped_db < kLeast_db - 10, 'both eyes see the same');
    expect(results.moved_db < kLeast_db - 10, 'a hand does not move the performer');
    expect(results.plays, 'a hand does not play');
    expect(results.refused.includes('inline'), `another mode is not refused: ${results.refused}`);
    expect(results.disposed.includes('left'), `a player that ended enters a headset: ${results.disposed}`);
}
if (!given) fs.rmSync(folder, {recursive: true});
for (const text of wrong) console.error(`wrong: ${text}`);
process.exit(wrong.length > 0 ? 1 : 0);
