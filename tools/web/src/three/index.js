// What a program with three.js imports: `import {PerformerMesh} from 'neuvv-player/three'`.
export {PerformerMesh} from './performer_mesh.js';
export {NeuvvPerformerExtension} from './gltf_extension.js';
