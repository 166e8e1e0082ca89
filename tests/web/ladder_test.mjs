// The ladder of the player for browsers, by the traces that the engine's is tested by, and the rate that it is given.
//   BUILT=… node --test ladder_test.mjs      (BUILT: what tools/web/build made)
import assert from 'node:assert';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import {fileURLToPath} from 'node:url';

const built = path.resolve(process.env.BUILT), here = path.dirname(fileURLToPath(import.meta.url));
const {ByteRate} = await import(`${built}/byte_rate.js`);
const {instantiated} = await import(`${built}/decoder.js`);
const {FramePace} = await import(`${built}/frame_pace.js`);
const codec = await instantiated(await WebAssembly.compile(fs.readFileSync(`${built}/decoder.wasm`)));
const readTraces = () => JSON.parse(fs.readFileSync(path.join(here, '../render/ladder_traces.json'), 'utf8'));

// The steps of a trace that come out in another way than it says.
function differences(trace, {bytes_until: bytesUntil, frames: frameCount, seconds}) {
    const pace = new FramePace(codec, trace.frames_at_once), found = [];
    const expect = (condition, step, value) => condition || found.push(`${JSON.stringify(step)}: ${value}`);
    for (const step of trace.steps) {
        for (let i = 0; i < (step.times ?? 0); ++i) {
            if (step.learn) {
                const {shapes, shapes_s, plane_bytes: planeBytes, planes_s, upload_s} = step.learn;
                pace.learn({shapes, shapes_s, planeBytes, planes_s}, upload_s);
            } else {
                pace.learnArrival(step.arrives_s);
            }
        }
        if (step.lead_s) {
            const lead_s = pace.lead();
            expect(lead_s >= step.lead_s[0] && lead_s <= step.lead_s[1], step, lead_s);
        } else if (step.parts) {
            const parts = pace.parts({number: step.choose, bytesUntil, frameCount, seconds}, step.bytes_per_s, step.at_s);
            expect(parts === step.parts, step, parts);
        }
    }
    return found;
}

test('the ladder chooses as its traces say', () => {
    const {traces, group} = readTraces();
    assert(traces.length > 5);
    for (const trace of traces) assert.deepStrictEqual(differences(trace, group), [], trace.name);
});

test('another choice or lead is a difference', () => {
    const {traces, group} = readTraces();
    for (const trace of traces) {
        let changed = 0;
        for (const step of trace.steps) {
            if (step.parts || step.lead_s) ++changed;
            if (step.parts) ++step.parts;
            if (step.lead_s) step.lead_s = [2, 3];
        }
        assert(changed > 0);
        assert.strictEqual(differences(trace, group).length, changed, trace.name);
    }
});

test('requests at the same time count once, and pauses not at all', () => {
    let now = 0;
    const rate = new ByteRate(() => now);
    assert.strictEqual(rate.perSecond, 0, 'nobody knows yet');
    for (let i = 0; i < 20; ++i) {
        rate.begin();
        now += 50;
        rate.begin();
        now += 100;
        rate.add(30000);
        rate.end();
        now += 50;
        rate.add(10000);
        rate.end();
        now += 5000;  // nothing is asked for
    }
    assert(Math.abs(rate.perSecond - 200000) < 1, `${rate.perSecond}`);
    for (let i = 0; i < 20; ++i) {
        rate.begin();
        now += 200;
        rate.add(4000);
        rate.end();
    }
    assert(Math.abs(rate.perSecond - 20000) < 1000, `${rate.perSecond}: what is old is forgotten`);
    rate.begin();
    now += 3600000;  // the page sleeps
    rate.end();
    assert(rate.perSecond > 3000, `${rate.perSecond} after an hour of sleep`);
});
