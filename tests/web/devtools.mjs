// Chromium's DevTools protocol, by the pipe of --remote-debugging-pipe: messages of JSON with a 0 behind each.

export class DevTools {
    #toBrowser; #waiting = new Map(); #listeners = new Map(); #next = 1; #rest = ''; #page = null; #workers = new Set();

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
    /** Calls `listener` with what each event of a name says. */
    listen(name, listener) { this.#listeners.set(name, listener); }
    /** The test's page: {targetId, sessionId}. */
    page() {
        this.#page ??= this.#attached();
        return this.#page;
    }
    /** The sessions of the page's workers. */
    async workers() {
        const {sessionId} = await this.page();
        await this.call('Target.setAutoAttach', {autoAttach: true, waitForDebuggerOnStart: false, flatten: true}, sessionId);
        return [...this.#workers];  // which it has told of
    }

    async #attached() {
        const {targetInfos: [{targetId}]} = await this.call('Target.getTargets', {filter: [{type: 'page'}]});
        return {targetId, ...await this.call('Target.attachToTarget', {targetId, flatten: true})};
    }
    #hear({id, method, params, result, error}) {
        if (method === 'Target.attachedToTarget' && params.targetInfo.type === 'worker') this.#workers.add(params.sessionId);
        if (method === 'Target.detachedFromTarget') this.#workers.delete(params.sessionId);
        this.#listeners.get(method)?.(params);
        const one = this.#waiting.get(id);
        if (!one) return;  // an event
        this.#waiting.delete(id);
        error ? one.reject(new Error(`${one.method}: ${error.message}`)) : one.resolve(result);
    }
}
