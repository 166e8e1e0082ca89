// The time maps of stages: the engine's own (engine/stage/time_map.h), in time_map.wasm.
import {compiled, copied, instantiated, textAt} from './decoder.js';

const kMembers = ['factor', 'by', 'at', 'for', 'from', 'to'];  // of operators in JSON, in the order of their text

let loading = null, engine = null;

// Once for all.
function loadedEngine() {
    loading ??= compiled(new URL('time_map.wasm', import.meta.url)).then(instantiated).catch(error => {
        loading = null;
        throw error;
    });
    return loading;
}

/** The text of a map that NEUVV_performer has as JSON: "loop:0s:2s,speed:0.5". */
export function timeMapText(operators) {
    if (!Array.isArray(operators)) throw new Error('"time" is not a list of operators');
    return operators.map(one => [one?.operator, ...kMembers.map(name => one?.[name]).filter(value => value !== undefined)].join(':')).join();
}

export class TimeMap {
    #map;
    /** From the time of a stage to a clip of so many frames. Throws an Error where the map is damaged. */
    static async of(mapText, frames, fps) {
        engine = await loadedEngine();
        const map = new TimeMap(), bytes = copied(engine, new TextEncoder().encode(`${mapText}\0`));
        map.#map = engine.neuvv_time_map_new(bytes, frames, fps);
        engine.free(bytes);
        if (!map.#map) throw new Error('there is no memory for a time map');
        const error = engine.neuvv_time_map_error(map.#map);
        if (!error) return map;
        const problem = textAt(engine, error);
        map.free();
        throw new Error(problem);
    }
    /** The frame that is shown at a time of the stage, seconds; between two it is not whole. */
    frame(stage_s) { return engine.neuvv_time_map_frame(this.#map, stage_s); }
    /** Where the clip is then for who hears it: frames. */
    position(stage_s) { return engine.neuvv_time_map_position(this.#map, stage_s); }
    /** Seconds until its end; Infinity where it has none. */
    get length() { return engine.neuvv_time_map_length(this.#map); }
    free() { engine.neuvv_time_map_free(this.#map); }
}
