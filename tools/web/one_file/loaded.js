// In place of src/loaded.js in a page of one file: what lies beside the modules is in the page. tools/web/build makes the
// script worker.txt of src/worker.js.
import decoder from './decoder.wasm';
import walk from './performer.frag';
import worker from './worker.txt';

const module = WebAssembly.compile(decoder), workerUrl = URL.createObjectURL(new Blob([worker], {type: 'text/javascript'}));

export const loadedWalk = async () => walk;
export const loadedDecoder = () => module;
export const newWorker = () => new Worker(workerUrl);
