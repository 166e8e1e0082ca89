// A page in Chromium that is asked from here, by a pipe, for pages that talk to no server.
import {started} from './browser.mjs';

const kMost_s = 120;

/** {call, evaluate, requests, end}. `script` runs in the page before its own; `requests`: addresses that it has asked for. */
export async function openedPage(url, script) {
    const {browser, log, end} = started(['--remote-debugging-pipe', '--window-size=400,400'], ['pipe', 'pipe']);
    const waiting = new Map(), requests = [];
    let said = '', count = 0;
    const answerTo = id => new Promise((resolve, reject) => waiting.set(id, {resolve, reject}));
    const fail = problem => {
        for (const {reject} of waiting.values()) reject(new Error(`${url}: ${problem}\n${log()}`));
    };
    const take = ({id, result, error, method, params}) => {
        if (method === 'Network.requestWillBeSent') requests.push(params.request.url);
        if (method === 'Page.loadEventFired') return take({id: 'load'});
        if (error) waiting.get(id)?.reject(new Error(error.message));
        waiting.get(id)?.resolve(result);
        waiting.delete(id);
    };
    browser.on('exit', code => fail(`chromium ended with ${code}`));
    browser.stdio[4].setEncoding('utf8').on('data', text => {
        const messages = (said + text).split('\0');
        said = messages.pop();
        for (const message of messages) take(JSON.parse(message));
    });
    const timer = setTimeout(() => fail(`nothing came in ${kMost_s} s`), 1000 * kMost_s);
    const send = (method, params, sessionId) => {
        browser.stdio[3].write(`${JSON.stringify({id: ++count, method, params, sessionId})}\0`);
        return answerTo(count);
    };
    const {targetId} = await send('Target.createTarget', {url: 'about:blank'});
    const {sessionId} = await send('Target.attachToTarget', {targetId, flatten: true});
    const call = (method, params = {}) => send(method, params, sessionId);
    /** What a function of the page returns, as JSON. */
    const evaluate = async (run, ...values) => {
        const expression = `(${run})(${values.map(value => JSON.stringify(value)).join()})`;
        const {result, exceptionDetails} = await call('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
        if (exceptionDetails) throw new Error(`${url}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
        return result.value;
    };
    await call('Page.enable');
    await call('Network.enable');
    await call('Page.addScriptToEvaluateOnNewDocument', {source: `(${script})()`});
    await Promise.all([answerTo('load'), call('Page.navigate', {url})]);
    return {call, evaluate, requests, end: () => {
        clearTimeout(timer);
        return end();
    }};
}
