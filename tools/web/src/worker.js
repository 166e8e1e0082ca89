// Decodes frames of one group after the other, and makes slice trees of them, in a worker.
//   in:  {id, group: {key, tables, depth, degree, mostLeaves, boxSize}, bytes, sizes, partCount, wantsTree}
//   out: {id, tree} or {id, error}
let codec, group = null, groupKey = null;

async function instantiated(url) {
    const answer = await fetch(url);  // not compiled while it comes, for which servers must know its type
    if (!answer.ok) throw new Error(`the decoder could not be loaded: the server answers ${answer.status}`);
    const imports = {}, module = await WebAssembly.compile(await answer.arrayBuffer());
    for (const {module: from, name} of WebAssembly.Module.imports(module))
        (imports[from] ??= {})[name] = () => {
            if (name !== 'emscripten_notify_memory_growth') throw new Error(`the decoder calls ${name}`);
        };
    const {exports} = await WebAssembly.instantiate(module, imports);
    exports._initialize?.();
    return exports;
}

function copied(bytes) {
    const place = codec.malloc(bytes.length + 1);
    if (!place) throw new Error('there is no memory for a frame');
    new Uint8Array(codec.memory.buffer).set(bytes, place);
    return place;
}

function enter(wanted) {
    if (groupKey === wanted.key) return;
    if (group) codec.neuvv_group_free(group);
    group = groupKey = null;
    const tables = copied(wanted.tables);
    group = codec.neuvv_group_new(tables, wanted.tables.length, wanted.depth, wanted.degree, wanted.mostLeaves);
    codec.free(tables);
    if (!group) throw new Error('the tables of the stream are damaged');
    groupKey = wanted.key;
}

function text(place) {
    const bytes = new Uint8Array(codec.memory.buffer);
    return new TextDecoder().decode(bytes.slice(place, bytes.indexOf(0, place)));
}

function decode(request) {
    const bytes = copied(request.bytes), sizes = copied(new Uint8Array(Uint32Array.from(request.sizes).buffer));
    const leaves = codec.neuvv_group_decode(group, bytes, request.bytes.length, sizes, request.partCount);
    codec.free(bytes);
    codec.free(sizes);
    if (leaves < 0) throw new Error(`a frame ${text(codec.neuvv_group_error(group))}`);
}

function sliceTree(request) {
    const tree = codec.neuvv_slice_tree_new(group, ...request.group.boxSize);
    if (!tree) throw new Error('there is no memory for a frame');
    const [nodes, entries, links, nodeLevels, topLevels, topFirst, topLast, scale] =
        new Uint32Array(codec.memory.buffer, codec.neuvv_slice_tree_shape(tree), 8);
    const words = (place, count) => new Uint32Array(codec.memory.buffer, place, count).slice();
    const result = {nodeLevels, topLevels, topFirst, topLast, scale, degree: request.group.degree,
                    nodes: words(codec.neuvv_slice_tree_nodes(tree), 4 * nodes),
                    entries: words(codec.neuvv_slice_tree_entries(tree), 2 * (request.group.degree + 1) ** 2 * entries),
                    links: words(codec.neuvv_slice_tree_links(tree), links)};
    codec.neuvv_slice_tree_free(tree);
    return result;
}

const ready = instantiated(new URL('decoder.wasm', import.meta.url)).then(exports => codec = exports);

self.onmessage = async ({data}) => {
    try {
        await ready;
        enter(data.group);
        decode(data);
        const tree = data.wantsTree ? sliceTree(data) : null;
        self.postMessage({id: data.id, tree}, tree ? [tree.nodes.buffer, tree.entries.buffer, tree.links.buffer] : []);
    } catch (error) {
        self.postMessage({id: data.id, error: String(error.message ?? error)});  // WebAssembly's have no message
    }
};
