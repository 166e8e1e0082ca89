// What tests need besides themselves: packages of npm, where they are installed, of which nothing is downloaded; and a
// program that finds the player.
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

/** A copy of the program in `folder`, which publishes the player that is in `built`: it looks for that beside its own folder. */
export function programWith(neuvv, built, folder) {
    const program = path.join(folder, 'program', 'neuvv');
    fs.mkdirSync(path.dirname(program));
    fs.copyFileSync(neuvv, program);
    fs.symlinkSync(path.resolve(built), path.join(folder, 'web'));
    return program;
}
