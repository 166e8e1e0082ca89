// Chromium's DevTools protocol, by the pipe of --remote-debugging-pipe: messages of JSON with a 0 behind each.

export class DevTools {
    #toBrowser; #waiting = new Map(); #next = 1; #rest = ''; #page = null;

    constructor(toBrowser, fromBrowser) {
        this.#toBrowser = toBrowser;
        toBrowser.on('error', () => {});  // the browser has ended
        fromBrowser.setEncoding('utf8').on('data', text => {
            const messages = (this.#rest + text).split('\0');
            this.#rest = messages.pop();
            for (const message of messages) this.#hear(JSON.parse(message));
        });
    }
    /** What a method answers. Without a session, it is asked of the browser. Throws an Error where it fails. */
    call(method, params = {}, sessionId = undefined) {
        const id = this.#next++;
        this.#toBrowser.write(`${JSON.stringify({id, method, params, sessionId})}\0`);
        return new Promise((resolve, reject) => this.#waiting.set(id, {method, resolve, reject}));
    }
    /** The test's page: {targetId, sessionId}. */
    page() {
        this.#page ??= this.#attach('page');
        return this.#page.then(([page]) => page);
    }
    /** The workers of the page, as page() has it. */
    workers() { return this.#attach('worker'); }

    async #attach(type) {
        const {targetInfos} = await this.call('Target.getTargets', {filter: [{type}]});
        return Promise.all(targetInfos.map(async ({targetId}) =>
            ({targetId, ...await this.call('Target.attachToTarget', {targetId, flatten: true})})));
    }
    #hear({id, result, error}) {
        const one = this.#waiting.get(id);
        if (!one) return;  // an event
        this.#waiting.delete(id);
        error ? one.reject(new Error(`${one.method}: ${error.message}`)) : one.resolve(result);
    }
}
