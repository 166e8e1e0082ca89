let walk = null;

/** The text of performer.frag, loaded once for all players. */
export function loadedWalk() {
    walk ??= fetch(new URL('performer.frag', import.meta.url)).then(answer => {
        if (!answer.ok) throw new Error(`performer.frag could not be loaded: the server answers ${answer.status}`);
        return answer.text();
    }).catch(error => {
        walk = null;
        throw error;
    });
    return walk;
}
