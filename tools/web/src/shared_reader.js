// Streams that several show at the same time are opened, fetched and kept once.
import {FrameReader} from './frames.js';

const opened = new Map();  // by address and budget: {reader: a promise, users: how many}

/** The reader of the stream at an address (FrameReader.open), and `letGo`, which ends it when nobody else has it. */
export async function openShared(url, budget) {
    const address = `${url} ${budget}`, one = opened.get(address) ?? {reader: FrameReader.open(url, budget), users: 0};
    const leave = () => --one.users === 0 && opened.delete(address);
    opened.set(address, one);
    ++one.users;
    try {
        const reader = await one.reader;
        return {reader, letGo: () => leave() && reader.end()};
    } catch (error) {
        leave();
        throw error;
    }
}
