// The module decoder.wasm: the engine's codec, slice trees and pace of frames (tools/web/*.h).

/** A module of WebAssembly at an address. */
export async function compiled(url) {
    const answer = await fetch(url);  // not compiled while it comes, for which servers must know its type
    if (!answer.ok) throw new Error(`the server answers ${answer.status}`);
    return WebAssembly.compile(await answer.arrayBuffer());
}

/** Its functions, with a memory of their own. */
export async function instantiated(module) {
    const imports = {};
    for (const {module: from, name} of WebAssembly.Module.imports(module))
        (imports[from] ??= {})[name] = () => {
            if (name !== 'emscripten_notify_memory_growth') throw new Error(`the decoder calls ${name}`);
        };
    const {exports} = await WebAssembly.instantiate(module, imports);
    exports._initialize?.();
    return exports;
}

/** The text at a place in its memory, which ends with a 0. */
export function textAt(codec, place) {
    const bytes = new Uint8Array(codec.memory.buffer);
    return new TextDecoder().decode(bytes.slice(place, bytes.indexOf(0, place)));
}

/** The place of a copy of the bytes in its memory, to be freed. Throws where there is no memory. */
export function copied(codec, bytes) {
    const place = codec.malloc(bytes.length + 1);
    if (!place) throw new Error('there is no memory for a frame');
    new Uint8Array(codec.memory.buffer).set(bytes, place);
    return place;
}
