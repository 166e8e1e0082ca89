// Packages of npm that tests take where they are installed; nothing is downloaded.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

function globalFolder() {
    try {
        return execFileSync('npm', ['root', '-g'], {encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore']}).trim();
    } catch {
        return '';
    }
}

/** The folder with the packages: NEUVV_NODE_MODULES, else npm's. Ends the test as skipped where a package is not there. */
export function folderWith(name) {
    const folder = process.env.NEUVV_NODE_MODULES ?? globalFolder();
    if (folder && fs.existsSync(path.join(folder, name))) return folder;
    console.log(`skipped: ${name} is not installed (npm install -g ${name}, or NEUVV_NODE_MODULES=FOLDER)`);
    process.exit(77);
}
