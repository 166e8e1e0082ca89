// What lies beside the modules: each is loaded once for all players. Bundlers know these expressions with import.meta.url.
// In a page of one file, one_file/loaded.js takes the place of this module.
import {compiled} from './decoder.js';

let walk = null, module = null;

/** The text of performer.frag. */
export function loadedWalk() {
    walk ??= fetch(new URL('performer.frag', import.meta.url)).then(answer => {
        if (!answer.ok) throw new Error(`performer.frag could not be loaded: the server answers ${answer.status}`);
        return answer.text();
    }).catch(error => {
        walk = null;
        throw error;
    });
    return walk;
}

/** decoder.wasm, compiled for all threads. */
export function loadedDecoder() {
    module ??= compiled(new URL('decoder.wasm', import.meta.url)).catch(error => {
        module = null;
        throw new Error(`the decoder could not be loaded: ${error.message}`);
    });
    return module;
}

/** A thread that runs worker.js. */
export const newWorker = () => new Worker(new URL('worker.js', import.meta.url), {type: 'module'});
